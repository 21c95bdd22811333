// The compared jobs in the address, so that it can be kept and shared: `jobs=a,b,c`, `reference=b` where that is not
// the oldest, and the options of the figures.

export const MOST = 5;

export function read() {
  const given = new URLSearchParams(window.location.search);
  const ids = [...new Set((given.get("jobs") ?? "").split(",").map((id) => id.trim().toLowerCase()).filter(Boolean))];
  const kept = ids.slice(0, MOST);
  const reference = given.get("reference")?.toLowerCase() ?? "";
  return { ids: kept, reference: kept.includes(reference) ? reference : oldest(kept), surplus: ids.length - kept.length };
}

/** The job that was submitted first: ids sort by that time. @param {string[]} ids */
export const oldest = (ids) => [...ids].sort()[0];

/** The address as names and values. */
export const told = () => new URLSearchParams(window.location.search);

/**
 * Keeps options of the figures in the address; an empty value is the usual one.
 * @param {Record<string, string>} options
 */
export function remember(options) {
  const { ids, reference } = read();
  Object.assign(kept, options);
  write({ ids, reference }, false);
}

/** Options in the address beside the jobs. @type {Record<string, string>} */
const kept = Object.fromEntries([...told()].filter(([name]) => !["jobs", "reference"].includes(name)));

/**
 * @param {{ ids: string[], reference: string }} view
 * @param {boolean} isStep whether it is an entry of its own in the history
 */
export function write({ ids, reference }, isStep) {
  const words = [ids.length ? `jobs=${ids.map(encodeURIComponent).join(",")}` : "", reference && reference !== oldest(ids) ? `reference=${encodeURIComponent(reference)}` : "", new URLSearchParams(Object.entries(kept).filter(([, value]) => value)).toString()];
  const search = words.filter(Boolean).join("&");
  const report = /** @type {HTMLAnchorElement | null} */ (document.getElementById("report-link"));
  if (report) report.href = `/compare/report${search ? `?${search}` : ""}`;
  window.history[isStep ? "pushState" : "replaceState"](null, "", window.location.pathname + (search ? `?${search}` : ""));
}
