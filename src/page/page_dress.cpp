// SPDX-License-Identifier: MIT
#include "page/page_dress.hpp"

namespace ripplenotch {

const std::string_view page_style = R"css(
:root { color-scheme: light dark; --ink: #1b1b1b; --paper: #fff; --soft: #4a5056; --rule: #d3d7db;
  --box: #f3f5f7; --link: #0b5394; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e6e8; --paper: #14171a; --soft: #aab1b8; --rule: #3a4047; --box: #1e2328; --link: #7cc0f4; }
  figure img { filter: invert(.92) hue-rotate(180deg); }
}
body { font: 16px/1.45 system-ui, sans-serif; color: var(--ink); background: var(--paper); margin: 0 auto;
  max-width: 62rem; padding: 1rem; overflow-wrap: anywhere; }
h1 { font-size: 1.5rem; margin: .2rem 0 1rem; }
h2 { font-size: 1.15rem; margin: 0 0 .4rem; }
section { border-top: 1px solid var(--rule); margin-top: 2.2rem; padding-top: 1rem; }
h3 { font-size: 1rem; margin: 1.2rem 0 .2rem; }
a { color: var(--link); text-decoration: none; }
a:hover { text-decoration: underline; }
.summary article { background: var(--box); border-radius: .5rem; padding: .8rem 1rem; margin: 0 0 .8rem; }
.summary h2 { font-size: 1rem; }
.summary p { font-weight: 600; margin: .2rem 0 .6rem; }
.summary .facts { margin: 0; }
nav h2 { margin-top: 1.4rem; }
nav ol { margin: 0; padding-left: 1.5rem; }
.verdict { font-size: 1.1rem; font-weight: 600; margin: .3rem 0 1rem; }
.facts { display: flex; flex-wrap: wrap; gap: .6rem; margin: 0 0 1rem; padding: 0; list-style: none; }
.facts li { border: 1px solid var(--rule); border-radius: .4rem; padding: .3rem .7rem; }
.facts b { display: block; font-size: 1.05rem; }
.facts span, .note, figcaption, dl { color: var(--soft); font-size: .9rem; }
figure { margin: 1.2rem 0; }
.plot { width: 100%; }
figure img { width: 100%; height: auto; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .7rem; text-align: right; border-bottom: 1px solid var(--rule); overflow-wrap: normal; }
th { vertical-align: bottom; }
th:first-child, td:first-child, .words { text-align: left; }
td.words { min-width: 6rem; }
td:first-child { min-width: 0; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .1rem .8rem; margin: .6rem 0; }
dt { font-weight: 600; }
dd { margin: 0; }
pre { background: var(--box); padding: .6rem; overflow-x: auto; font-size: .85rem; white-space: pre-wrap; }
details { margin: .6rem 0; }
details > summary { cursor: pointer; color: var(--soft); }
@media (max-width: 32rem) { body { padding: .7rem; font-size: 15px; } .facts li { flex: 1 1 40%; } }
@media (max-width: 45rem) { figure { overflow-x: auto; } figure img { width: 44rem; } }
@media print { :root { --ink: #000; --paper: #fff; --soft: #444; --rule: #ccc; --box: #fff; --link: #000; }
  body { max-width: none; padding: 0; } details, .modebar { display: none; }
  figure, table, article { break-inside: avoid; } figure img { filter: none; } }
)css";

// The figures come in the colours of paper; at night each of these has another that stands out as much. White
// names on a heat map stay white, since the map stays as it is.
const std::string_view page_script = R"js(
const dark = matchMedia("(prefers-color-scheme: dark)"), narrow = matchMedia("(max-width: 45rem)");
const night = {"#1b1b1b": "#e4e6e8", "#222": "#e4e6e8", "#444": "#aab1b8", "#555": "#8f969d", "#888": "#8f969d",
  "#e3e3e3": "#333940", "#eeeeee": "#22272c", "#000000": "#e4e6e8", "#0072b2": "#3ea0dc", "#808080": "#9aa1a8"};
const coloured = new Set(["color", "gridcolor", "linecolor", "fillcolor", "plot_bgcolor"]);
function dressed(value, key) {
  if (Array.isArray(value)) return typeof value[0] === "object" ? value.map((one) => dressed(one, "")) : value;
  if (value && typeof value === "object")
    return Object.fromEntries(Object.entries(value).map(([name, one]) => [name, dressed(one, name)]));
  if (typeof value !== "string" || !coloured.has(key)) return value;
  if (key === "plot_bgcolor" && value === "#ffffff") return "rgba(0,0,0,0)";
  return night[value] || (night[value.slice(0, 7)] || value.slice(0, 7)) + value.slice(7);
}
function narrowed(figure) {
  for (const {path, value} of figure.narrow || []) {
    const names = path.split("/").slice(1), last = names.pop();
    names.reduce((within, name) => within[name], figure)[last] = value;
  }
  return figure;
}
function draw(source, light) {
  const place = document.getElementById(source.dataset.figure);
  const whole = JSON.parse(source.textContent), read = narrow.matches ? narrowed(whole) : whole;
  const figure = dark.matches && !light ? dressed(read, "") : read;
  figure.layout.paper_bgcolor = "rgba(0,0,0,0)";
  figure.layout.modebar = {bgcolor: "rgba(0,0,0,0)"};
  const config = {responsive: true, displaylogo: false, showSendToCloud: false, plotlyServerURL: "",
                  modeBarButtonsToRemove: ["lasso2d", "select2d"]};
  return Plotly.react(place, figure.data, figure.layout, config).then(() => {
    place.dataset.drawn = figure.data.length;
    place.dataset.points = figure.data.reduce((sum, trace) => sum + (trace.x ? trace.x.length : 0), 0);
  });
}
const sources = [...document.querySelectorAll("script[data-figure]")];
const draw_all = (light) => sources.forEach((source) => draw(source, light));
draw_all(false);
dark.addEventListener("change", () => draw_all(false));
narrow.addEventListener("change", () => draw_all(false));
addEventListener("beforeprint", () => draw_all(true));
addEventListener("afterprint", () => draw_all(false));
)js";

}  // namespace ripplenotch
