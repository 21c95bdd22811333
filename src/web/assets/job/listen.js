// The acceleration of the chosen channel as a sound: the record, repeated.

import { soundUrl } from "../common/api.js";
import { byId, notify, show } from "../common/dom.js";

export class Listening {
  /** @param {string} id @param {SeriesChannel[]} catalogue */
  constructor(id, catalogue) {
    this.id = id;
    this.accelerations = new Set(catalogue.filter(({ quantity }) => quantity.includes("acceleration")).map(({ name }) => name));
    this.button = byId("play");
    this.sound = new Audio();
    this.sound.preload = "none";
    this.button.addEventListener("click", () => this.toggle());
    for (const event of ["play", "pause", "ended"]) this.sound.addEventListener(event, () => this.tell());
  }

  /** Takes up the acceleration that belongs to a channel. @param {string} channel */
  choose(channel) {
    const name = [channel, `a_${channel.replace(/^v_/, "")}`].find((one) => this.accelerations.has(one));
    show(this.button, name !== undefined);
    if (name === this.name) return;
    this.name = name;
    this.sound.pause();
    this.sound.removeAttribute("src");
    this.button.title = name ? `The acceleration ${name}, its record repeated for five seconds` : "";
  }

  async toggle() {
    if (!this.name) return;
    if (!this.sound.paused) return this.sound.pause();
    if (!this.sound.getAttribute("src")) this.sound.src = soundUrl(this.id, this.name);
    this.sound.currentTime = 0;
    try {
      await this.sound.play();
    } catch (error) {
      notify(byId("notice"), error);
    }
  }

  tell() {
    const plays = !this.sound.paused;
    this.button.setAttribute("aria-pressed", String(plays));
    this.button.textContent = plays ? "Stop" : "Listen";
  }
}
