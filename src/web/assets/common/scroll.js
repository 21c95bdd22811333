// Boxes in which wide things scroll can be scrolled with the keyboard, while there is something to scroll.

const BOXES = ".scroll";

function fit(box) {
  const scrolls = box.scrollWidth > box.clientWidth + 1 || box.scrollHeight > box.clientHeight + 1;
  if (!scrolls) {
    box.removeAttribute("tabindex");
    return;
  }
  box.tabIndex = 0;
  if (box.hasAttribute("role")) return;
  const caption = box.querySelector("caption")?.textContent.trim();
  if (!caption) return;
  box.setAttribute("role", "group");
  box.setAttribute("aria-label", caption);
}

const sizes = new ResizeObserver((changes) => {
  for (const box of new Set(changes.map(({ target }) => target.closest(BOXES)))) if (box) fit(box);
});

function watch(box) {
  sizes.observe(box);
  for (const child of box.children) sizes.observe(child);
}

document.querySelectorAll(BOXES).forEach(watch);
new MutationObserver((changes) => {
  for (const { target, addedNodes } of changes) {
    if (target instanceof Element && target.matches(BOXES)) watch(target);
    for (const node of addedNodes) {
      if (!(node instanceof HTMLElement)) continue;
      if (node.matches(BOXES)) watch(node);
      node.querySelectorAll(BOXES).forEach(watch);
    }
  }
}).observe(/** @type {HTMLElement} */ (document.getElementById("main")), { childList: true, subtree: true });
