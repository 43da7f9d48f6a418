#include "host/lab/report/report_style.hpp"

namespace octoskin::report {

// Swatches repeat host/lab/report/colour.hpp's palette: pictures and legend must agree.
std::string_view report_style() noexcept {
    return R"css(
:root {
  color-scheme: light dark;
  --page: #fbfbf9; --panel: #f0f1f3; --ink: #1c2129; --soft: #5a6472; --rule: #d9dce1;
  --depth: #2b6cb0; --proximity: #b7430f; --fused: #4b7f2b; --miss: #7a828e; --accent: #2b6cb0;
  --right: #5b9bd5; --hidden: #f2c230; --wrong: #d1481f; --lost: #9a6fb8; --floor: #b9c0ca;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #14171c; --panel: #1f242c; --ink: #e7e9ec; --soft: #a2abb8; --rule: #353c47;
    --depth: #6fb0ee; --proximity: #f0915c; --fused: #94cf6b; --miss: #98a1ae; --accent: #6fb0ee;
  }
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 1.0625rem/1.6 Charter, "Bitstream Charter", "Sitka Text", Cambria, Georgia, serif; }
main { max-width: 76rem; margin: 0 auto; padding: 2.5rem clamp(1rem, 4vw, 3rem) 5rem; }
h1 { font-size: clamp(1.9rem, 4.5vw, 2.9rem); line-height: 1.12; letter-spacing: -0.015em; margin: 0 0 .6rem; }
h2 { font-size: 1.5rem; line-height: 1.25; margin: 3.6rem 0 .6rem; }
h3 { font: 600 .95rem/1.4 system-ui, sans-serif; margin: 1.6rem 0 .3rem; }
p, li { max-width: 68ch; }
p { margin: .5rem 0 1rem; }
.lead { font-size: 1.2rem; line-height: 1.5; max-width: 62ch; }
.soft, figcaption, caption { color: var(--soft); }
code, pre { font: .88em/1.5 ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; }
pre { background: var(--panel); padding: .9rem 1.1rem; border-radius: .5rem; overflow-x: auto; }
a { color: var(--accent); }

.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(13.5rem, 1fr)); gap: 1rem;
  margin: 1.8rem 0 1rem; font-family: system-ui, sans-serif; }
.tile { background: var(--panel); border-radius: .7rem; padding: 1rem 1.15rem 1.05rem; }
.tile .what { font-size: .86rem; color: var(--soft); line-height: 1.35; min-height: 2.7em; }
.tile .big { font-size: 2.05rem; font-weight: 650; letter-spacing: -.02em; margin: .3rem 0 .1rem;
  font-variant-numeric: tabular-nums; white-space: nowrap; }
.tile .big .from { color: var(--soft); font-weight: 400; font-size: 1.25rem; }
.tile .note { font-size: .84rem; line-height: 1.4; }

.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(17rem, 1fr)); gap: 1.2rem; }
.scene { grid-template-columns: 1fr; }
.scene .pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(19rem, 1fr)); gap: .6rem; }
figure { margin: 0; }
figure.chart { max-width: 46rem; margin: 1.2rem 0; }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(26rem, 100%), 1fr)); gap: 0 2.5rem; }
@media (min-width: 62rem) {
  .split { display: grid; grid-template-columns: minmax(18rem, 26rem) minmax(0, 1fr); gap: 0 3rem; }
  .split h2 { grid-column: 1 / -1; }
  .split figure.chart { margin-top: .4rem; }
}
figcaption { font: .88rem/1.45 system-ui, sans-serif; margin-top: .5rem; max-width: 72ch; }
figcaption b { color: var(--ink); }
.map-view { background: var(--panel); border-radius: .7rem; padding: .8rem; max-width: 60rem; }
.map-buttons { display: flex; flex-wrap: wrap; gap: .5rem; margin-bottom: .6rem; font-family: system-ui, sans-serif; }
.map-buttons button { font: inherit; font-size: .9rem; color: var(--ink); background: var(--page); padding: .35rem .8rem;
  border: 1px solid var(--rule); border-radius: .5rem; cursor: pointer; }
.map-buttons button[aria-pressed=true] { border-color: var(--accent); box-shadow: inset 0 0 0 1px var(--accent); }
.map-canvas { height: min(60vh, 34rem); }
.map-canvas canvas { display: block; width: 100%; height: 100%; border-radius: .5rem; }
.map-said { font: .88rem/1.45 system-ui, sans-serif; margin: .6rem 0 0; min-height: 2.9em; }
.zoom { display: block; position: relative; background: var(--panel); border-radius: .6rem; overflow: hidden;
  cursor: zoom-in; }
.zoom + .zoom { margin-top: .6rem; }
.scene .zoom + .zoom { margin-top: 0; }
.zoom input { position: absolute; opacity: 0; pointer-events: none; }
.zoom img { display: block; width: 100%; height: auto; }
.zoom .side { position: absolute; left: .7rem; top: .55rem; font: .78rem/1 system-ui, sans-serif;
  color: var(--soft); }
.zoom:focus-within { outline: 2px solid var(--accent); outline-offset: 2px; }
.zoom input:checked ~ img { position: fixed; inset: 0; width: 100vw; height: 100vh; object-fit: contain;
  background: var(--panel); z-index: 9; cursor: zoom-out; }
.legend { display: flex; flex-wrap: wrap; gap: .4rem 1.3rem; padding: 0; margin: .8rem 0 1.2rem; list-style: none;
  font: .9rem/1.4 system-ui, sans-serif; }
.legend i { display: inline-block; width: .95rem; height: .95rem; border-radius: .2rem; margin-right: .45rem;
  vertical-align: -.12rem; }
.legend .line { height: 0; width: 1.5rem; border-top: 3px solid; border-radius: 0; vertical-align: .25rem; }
.swatch-right { background: var(--right); } .swatch-hidden { background: var(--hidden); }
.swatch-wrong { background: var(--wrong); } .swatch-floor { background: var(--floor); }
.swatch-better { background: var(--depth); opacity: .5; } .swatch-worse { background: var(--proximity); opacity: .5; }
.swatch-lost { border: 2px solid var(--lost); }
.line.depth { border-color: var(--depth); } .line.proximity { border-color: var(--proximity); }
.line.fused { border-color: var(--fused); }

.table { overflow-x: auto; margin: 1rem 0 1.2rem; }
table { border-collapse: collapse; font: .92rem/1.4 system-ui, sans-serif; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-size: .88rem; padding-bottom: .5rem; caption-side: top; max-width: 72ch; }
th, td { padding: .32rem .95rem .32rem 0; text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
td.name { text-align: left; }
thead th { border-bottom: 1.5px solid var(--ink); font-weight: 600; vertical-align: bottom; }
tbody tr { border-bottom: 1px solid var(--rule); }
tbody tr.group { border-bottom: 0; }
tbody tr.group th { padding-top: .9rem; font-weight: 650; }
tbody th { font-weight: 500; }
tr.paper td, tr.paper th { font-style: italic; color: var(--soft); }
tr.main td, tr.main th { font-weight: 650; }
details { margin: .8rem 0; }
summary { cursor: pointer; font: 600 .98rem/1.5 system-ui, sans-serif; }

svg { display: block; width: 100%; height: auto; font-family: system-ui, sans-serif; }
svg text { fill: var(--ink); font-size: 13px; }
svg .tick, svg .label { fill: var(--soft); font-size: 12.5px; }
svg .row { font-size: 13.5px; } svg .value { font-size: 12.5px; font-variant-numeric: tabular-nums; }
svg .grid { stroke: var(--rule); stroke-width: 1; } svg .axis { stroke: var(--soft); stroke-width: 1; }
svg .line { fill: none; stroke: var(--soft); stroke-width: 2.4; stroke-linejoin: round; }
svg .line.depth { stroke: var(--depth); } svg .line.proximity { stroke: var(--proximity); }
svg .line.fused { stroke: var(--fused); }
svg .line.miss { stroke: var(--miss); stroke-dasharray: 6 4; stroke-width: 1.6; }
svg .line.ideal { stroke: var(--soft); stroke-dasharray: 3 4; stroke-width: 1.4; }
svg .line.passed { stroke-dasharray: 6 4; stroke-width: 1.6; }
svg .line.faint { stroke-width: 1.4; stroke-dasharray: 2 3; }
svg .dot { fill-opacity: .55; fill: var(--soft); }
svg .dot.depth { fill: var(--depth); } svg .dot.proximity { fill: var(--proximity); }
svg .dot.fused { fill: var(--fused); }
svg .note.depth { fill: var(--depth); } svg .note.proximity { fill: var(--proximity); }
svg .note.fused { fill: var(--fused); }
svg .note.miss { fill: var(--miss); }
svg .bar { fill-opacity: .38; } svg .bar.better { fill: var(--depth); } svg .bar.worse { fill: var(--proximity); }
svg .seed { fill: var(--ink); fill-opacity: .85; }
@media print { .zoom { break-inside: avoid; } h2 { break-after: avoid; } }
)css";
}

}  // namespace octoskin::report
