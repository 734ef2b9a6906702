#include "app/report/page.hpp"

namespace grainlaw::app::report {

// k0..k7 are the colours of figure.hpp in order: the palette by Okabe and Ito, a little darker on white where its sky
// blue and orange would be faint, a little lighter on dark ground, and grey.
const char* page_style() {
  return R"(:root {
  color-scheme: light dark;
  --ground: #ffffff; --text: #1b1b1b; --quiet: #5c5c5c; --rule: #d8d8d8; --grid: #ececec; --band: #f6f6f6; --link: #005a9c;
  --k0: #1b1b1b; --k1: #0072b2; --k2: #d55e00; --k3: #009e73; --k4: #b2578f; --k5: #c98a00; --k6: #3a9bd3;
}
@media (prefers-color-scheme: dark) {
  :root {
    --ground: #14171a; --text: #e6e6e6; --quiet: #a3a8ad; --rule: #3b4046; --grid: #262a2f; --band: #1c2024; --link: #7cc4ff;
    --k0: #e6e6e6; --k1: #4aa8e0; --k2: #ff8a3d; --k3: #2fc79a; --k4: #dd8fc0; --k5: #f0b429; --k6: #8fd0f5;
  }
}
* { box-sizing: border-box; }
html { background: var(--ground); color: var(--text); font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; }
body { max-width: 66rem; margin: 0 auto; padding: 1.5rem 1rem 4rem; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .5rem; }
h2 { font-size: 1.25rem; margin: 2.5rem 0 .75rem; padding-top: .75rem; border-top: 1px solid var(--rule); }
p { max-width: 46rem; }
a { color: var(--link); }
code { font: .85em ui-monospace, "DejaVu Sans Mono", monospace; overflow-wrap: anywhere; }
td { overflow-wrap: anywhere; }
td.number, td.symbol { overflow-wrap: normal; }
.long { min-width: 13rem; }
figure { margin: 1.5rem 0 2rem; }
figcaption { max-width: 56rem; font-size: .9rem; margin-top: .4rem; }
.source { color: var(--quiet); }
details { margin: 1rem 0; }
summary { cursor: pointer; font-weight: 600; }
.scroll { overflow-x: auto; }
.unseen { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); margin: 0; }
.anchor { color: var(--quiet); font-weight: 400; }
.panels { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, var(--least)), 1fr)); }
.columns1 { --least: 34rem; } .columns2 { --least: 25rem; } .columns3 { --least: 17.5rem; } .columns4 { --least: 14rem; }
.columns5, .columns6 { --least: 12rem; }
svg { font: 12px system-ui, "DejaVu Sans", sans-serif; }
.panels > svg { display: block; width: 100%; max-width: 40rem; height: auto; }
svg.p:focus-visible { outline: 2px solid var(--link); }
svg text { fill: var(--text); }
svg .title { font-weight: 600; }
svg .grid { fill: none; stroke: var(--grid); }
svg .axis { fill: none; stroke: var(--quiet); stroke-width: .8; }
.b { fill: currentColor; fill-opacity: .14; }
.e, .l { fill: none; stroke: currentColor; stroke-linejoin: round; }
.d1 { stroke-dasharray: 7 4; } .d2 { stroke-dasharray: 1.5 3.5; stroke-linecap: round; }
.m { fill: none; } .f { fill: currentColor; } .o { fill: none; stroke: currentColor; stroke-width: 1.2; }
.ring { fill: none; stroke: var(--text); stroke-width: 1.5; pointer-events: none; }
.box { fill: var(--link); fill-opacity: .12; stroke: var(--link); }
.legend, .toggles, .tools { display: flex; flex-wrap: wrap; gap: .1rem 1rem; align-items: center; font-size: .85rem; }
.toggles { flex-basis: 100%; }
.legend label { cursor: pointer; padding: .15rem 0; }
svg.k { width: 24px; height: 16px; vertical-align: -3px; margin: 0 .3rem; }
.tools { gap: .3rem; margin: .3rem 0; }
button { font: inherit; color: var(--text); background: var(--band); border: 1px solid var(--rule); border-radius: 3px; padding: .1rem .6rem; cursor: pointer; }
.sort { font-weight: 600; text-align: inherit; background: none; border: 0; padding: 0; }
.sort::after { content: " ⇅"; color: var(--quiet); }
[aria-sort=ascending] .sort::after { content: " ↑"; } [aria-sort=descending] .sort::after { content: " ↓"; }
.tip { position: absolute; max-width: 20rem; background: var(--ground); border: 1px solid var(--quiet); padding: .2rem .5rem; font-size: .8rem; pointer-events: none; }
.k0 { color: var(--k0); } .k1 { color: var(--k1); } .k2 { color: var(--k2); } .k3 { color: var(--k3); }
.k4 { color: var(--k4); } .k5 { color: var(--k5); } .k6 { color: var(--k6); } .k7 { color: var(--quiet); }
table { border-collapse: collapse; font-size: .9rem; margin: 1rem 0 1.5rem; }
caption { text-align: left; font-weight: 600; padding-bottom: .4rem; }
caption .source { font-weight: 400; }
th, td { padding: .2rem .5rem; text-align: left; vertical-align: baseline; font-weight: 400; }
thead th { font-weight: 600; border-bottom: 1.5px solid var(--quiet); }
tbody tr { border-bottom: 1px solid var(--rule); }
tbody tr:nth-child(even) { background: var(--band); }
.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.symbol { white-space: nowrap; }
sub, sup { line-height: 0; font-size: 75%; }
/* narrow: each row of a wide table is a card; what stands before its cells is told for each table */
@media (max-width: 44rem) {
  table { font-size: .8rem; }
  th, td { padding: .2rem .3rem; }
  .number, .symbol { white-space: normal; }
  .cards, .cards caption, .cards tbody { display: block; }
  .cards thead { position: absolute; clip-path: inset(50%); width: 1px; height: 1px; overflow: hidden; }
  .cards tbody tr { display: grid; grid-template-columns: 1fr 1fr; column-gap: 1rem; padding: .4rem 0; }
  .cards tbody th, .cards .long, .cards .note td { grid-column: 1 / 3; text-align: left; }
  .cards tbody th { font-weight: 600; }
  .cards td { display: flex; flex-wrap: wrap; justify-content: space-between; column-gap: .5rem; }
  .cards td::before { color: var(--quiet); }
  .cards td:empty { display: none; }
  .cards .note td::before { content: none !important; }
  .cards [class*=heat]::before { color: inherit; }
  .columns1 svg.p, .columns2 svg.p { font-size: 14px; }
  .long { min-width: 0; }
}
@media print {
  :root {
    --ground: #ffffff; --text: #000000; --quiet: #444444; --rule: #bbbbbb; --grid: #e8e8e8; --band: #ffffff; --link: #000000;
    --k0: #000000; --k1: #0072b2; --k2: #d55e00; --k3: #009e73; --k4: #b2578f; --k5: #c98a00; --k6: #3a9bd3;
  }
  @page { margin: 11mm; }
  html { font-size: 9pt; line-height: 1.35; }
  body { max-width: none; padding: 0; }
  p, ul { margin: .4rem 0; max-width: none; } table { margin: .4rem 0 .8rem; } details { margin: .3rem 0; }
  th, td { padding: .08rem .4rem; }
  h2 { margin: .8rem 0 .3rem; padding-top: .3rem; }
  figure { margin: .4rem 0 .6rem; } figcaption { max-width: none; font-size: .85rem; margin: 0; }
  .columns1, .columns2 { --least: 44%; } .columns3 { --least: 30%; } .columns4, .columns5, .columns6 { --least: 21%; }
  .scroll { overflow: visible; }
  nav, .anchor, .tools, .tip, .toggles, .legend input, .legend label:has(input:not(:checked)) { display: none; }
  .sort::after { content: none !important; }
  figure, tbody tr { break-inside: avoid; }
  h2, caption { break-after: avoid; }
}
)";
}

}  // namespace grainlaw::app::report
