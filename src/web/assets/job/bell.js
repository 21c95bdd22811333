// A notification by the browser when a job ends, for those who ask for it.

import { byId, show } from "../common/dom.js";

const WORDS = { succeeded: "has a result", failed: "failed", canceled: "was canceled" };

export class Bell {
  /** @param {string} id of the job */
  constructor(id) {
    this.id = id;
    this.key = `notify-${id}`;
    this.isWanted = window.sessionStorage.getItem(this.key) === "1" && this.canRing();
    byId("notify").addEventListener("click", () => this.turn());
  }

  canRing() {
    return "Notification" in window && Notification.permission === "granted";
  }

  /** Shows the button while the job is live and the browser has notifications. @param {boolean} isLive */
  show(isLive) {
    const button = byId("notify");
    show(button, isLive && "Notification" in window && window.isSecureContext);
    button.setAttribute("aria-pressed", String(this.isWanted));
  }

  /** Asks for the browser's permission where there is none yet: only here, upon a click. */
  async turn() {
    const note = byId("life-note");
    if (!this.isWanted && Notification.permission === "default") await Notification.requestPermission();
    if (!this.isWanted && !this.canRing()) {
      note.textContent = "The browser does not allow notifications of this site; its settings can change that.";
      return;
    }
    this.isWanted = !this.isWanted;
    window.sessionStorage.setItem(this.key, this.isWanted ? "1" : "0");
    byId("notify").setAttribute("aria-pressed", String(this.isWanted));
    note.textContent = this.isWanted ? "You will be notified when the job ends, while this page is open." : "";
  }

  /** Tells the end of the job, once. @param {Job} job @param {string} title */
  ring(job, title) {
    if (!this.isWanted) return;
    this.isWanted = false;
    window.sessionStorage.removeItem(this.key);
    try {
      const told = new Notification(title, { body: `The job ${WORDS[job.state] ?? job.state}.`, tag: this.id, icon: "/assets/icon.svg" });
      told.addEventListener("click", () => window.focus());
    } catch {
      // Some browsers have notifications only for installed pages.
    }
  }
}
