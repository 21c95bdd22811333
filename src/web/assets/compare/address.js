// The compared jobs in the address, so that it can be kept and shared: `jobs=a,b,c`, and `reference=b` where that is
// not the first.

export const MOST = 5;

export function read() {
  const given = new URLSearchParams(window.location.search);
  const ids = [...new Set((given.get("jobs") ?? "").split(",").map((id) => id.trim().toLowerCase()).filter(Boolean))];
  const kept = ids.slice(0, MOST);
  const reference = given.get("reference")?.toLowerCase() ?? "";
  return { ids: kept, reference: kept.includes(reference) ? reference : kept[0], surplus: ids.length - kept.length };
}

/**
 * @param {{ ids: string[], reference: string }} view
 * @param {boolean} isStep whether it is an entry of its own in the history
 */
export function write({ ids, reference }, isStep) {
  const words = [ids.length ? `jobs=${ids.map(encodeURIComponent).join(",")}` : "", reference && reference !== ids[0] ? `reference=${encodeURIComponent(reference)}` : ""];
  const search = words.filter(Boolean).join("&");
  window.history[isStep ? "pushState" : "replaceState"](null, "", window.location.pathname + (search ? `?${search}` : ""));
}
