// The view of a response in the address, so that it can be linked to and is there again on the way back: channels,
// window, plane and scale.

/** The view that the address names. */
export const told = () => new URLSearchParams(window.location.search);

/** Keeps values in the address; without a value a name is left out. @param {Record<string, string | null>} values */
export function remember(values) {
  const kept = told();
  for (const [name, value] of Object.entries(values)) {
    if (value) kept.set(name, value);
    else kept.delete(name);
  }
  const search = kept.toString();
  window.history.replaceState(window.history.state, "", `${window.location.pathname}${search ? `?${search}` : ""}${window.location.hash}`);
}
