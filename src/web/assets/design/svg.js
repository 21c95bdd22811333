// Making SVG elements.

const SPACE = "http://www.w3.org/2000/svg";

export function svg(tag, attributes = {}) {
  const node = document.createElementNS(SPACE, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}

export const group = (name, attributes = {}) => svg("g", { class: name, ...attributes });

export function text(name, x, y, content, anchor = "start") {
  const node = svg("text", { class: name, x, y, "text-anchor": name === "name" ? "middle" : anchor });
  node.textContent = content;
  return node;
}

export function put(parent, ...children) {
  parent.append(...children);
}
