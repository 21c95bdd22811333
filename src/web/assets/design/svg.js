// Making SVG elements.

const SPACE = "http://www.w3.org/2000/svg";

/**
 * @template {keyof SVGElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Record<string, any>} [attributes]
 */
export function svg(tag, attributes = {}) {
  const node = document.createElementNS(SPACE, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}

/** @param {string} name @param {Record<string, any>} [attributes] */
export const group = (name, attributes = {}) => svg("g", { class: name, ...attributes });

/** @param {string} name @param {number} x @param {number} y @param {string} content @param {string} [anchor] */
export function text(name, x, y, content, anchor = "start") {
  const node = svg("text", { class: name, x, y, "text-anchor": name === "name" ? "middle" : anchor });
  node.textContent = content;
  return node;
}

/** @param {Element} parent @param {Node[]} children */
export function put(parent, ...children) {
  parent.append(...children);
}
