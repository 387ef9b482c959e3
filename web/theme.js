"use strict";
// Colours of all pictures: CSS variables, so that they follow the page into dark mode and onto paper.
const theme = (() => {
  const style = getComputedStyle(document.documentElement);
  const color = name => style.getPropertyValue(`--${name}`).trim();
  const pictures = new Set();  // functions that draw again; an argument asks for the width of the page, too
  const onChange = draw => pictures.add(draw);
  const forget = draw => pictures.delete(draw);
  const drawAll = fit => { for (const draw of pictures) draw(fit); };

  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => drawAll(false));
  const print = isPrinting => {
    document.documentElement.classList.toggle("print", isPrinting);
    drawAll(true);
  };
  addEventListener("beforeprint", () => print(true));
  addEventListener("afterprint", () => print(false));

  // Curves of one role have one colour and one dash on all pictures.
  const DASH = { numerical: [7, 3], improved: [9, 3, 2, 3], beside: [3, 2], "fixed base": [2, 3], input: [4, 2], raw: [5, 4], limit: [5, 4], before: [6, 2] };
  const css = name => `var(--${name.replace(" ", "-")})`;
  const ink = name => color(name.replace(" ", "-"));

  return { color: ink, css, DASH, pictures, onChange, forget };
})();
