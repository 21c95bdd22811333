// Light or dark: as the system has it, or as chosen in the footer. A plain script that runs before the first paint, so
// that no page flashes.

(() => {
  const KEY = "herringbone.scheme";
  const root = document.documentElement;

  function stored() {
    // A browser may keep pages from storing anything.
    try {
      return localStorage.getItem(KEY) ?? "";
    } catch {
      return "";
    }
  }

  function apply(scheme) {
    if (scheme === "light" || scheme === "dark") root.dataset.scheme = scheme;
    else delete root.dataset.scheme;
  }

  const tell = () => window.dispatchEvent(new Event("schemechange"));

  function choose(scheme) {
    try {
      if (scheme) localStorage.setItem(KEY, scheme);
      else localStorage.removeItem(KEY);
    } catch {
      // It holds for this page then.
    }
    apply(scheme);
    tell();
  }

  apply(stored());
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", tell);
  document.addEventListener("DOMContentLoaded", () => {
    const choice = /** @type {HTMLSelectElement | null} */ (document.getElementById("scheme"));
    if (!choice) return;
    choice.value = root.dataset.scheme ?? "";
    choice.addEventListener("change", () => choose(choice.value));
    // Another window of this browser chose.
    window.addEventListener("storage", (event) => {
      if (event.key !== KEY) return;
      apply(event.newValue ?? "");
      choice.value = root.dataset.scheme ?? "";
      tell();
    });
  });
})();
