// Words beside the pointer, over a canvas; kept inside its card.

export function tip(canvas) {
  const box = document.createElement("div");
  Object.assign(box, { className: "tip", hidden: true });
  box.setAttribute("role", "status");
  canvas.parentNode.append(box);
  return (text, x = 0, y = 0) => {
    box.hidden = !text;
    if (!text) return;
    if (box.textContent !== text) box.textContent = text;
    const left = canvas.offsetLeft, top = canvas.offsetTop;
    box.style.left = `${left + Math.max(0, Math.min(x + 14, canvas.clientWidth - box.offsetWidth))}px`;
    box.style.top = `${top + (y > canvas.clientHeight / 2 ? y - box.offsetHeight - 10 : y + 16)}px`;
  };
}
