#include "app/report/page.hpp"

namespace grainlaw::app::report {

// heat0..heat4 go from the best to the worst in steps of lightness of one blue, so that they are told apart without colour;
// the numbers stand in the cells.
const char* block_style() {
  return R"(:root {
  --heat0: #f3f8fc; --heat1: #d3e5f3; --heat2: #9dc6e3; --heat3: #2c70a3; --heat4: #0c3c62; --on-heat: #ffffff;
  --good: #00734f; --fair: #9a6700; --poor: #b3261e;
}
@media (prefers-color-scheme: dark) {
  :root {
    --heat0: #18222b; --heat1: #1e3a52; --heat2: #2b5f88; --heat3: #5ea3d3; --heat4: #c3e2f7; --on-heat: #10161b;
    --good: #2fc79a; --fair: #f0b429; --poor: #ff8a80;
  }
}
.verdict { font-size: 1.1rem; max-width: none; border-left: 5px solid; padding-left: .75rem; margin: .6rem 0; }
.verdict.good { border-color: var(--good); } .verdict.fair { border-color: var(--fair); }
.verdict.poor { border-color: var(--poor); }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(9.5rem, 1fr)); gap: .6rem; margin: .3rem 0; }
.tiles div { border: 1px solid var(--rule); border-radius: 4px; padding: .35rem .6rem; }
.tiles dt { font-size: .85rem; color: var(--quiet); }
.tiles dd { margin: 0; font-size: .82rem; line-height: 1.35; }
.tiles b { display: block; font-size: 1.45rem; line-height: 1.2; font-weight: 600; }
header > .source { font-size: .9rem; margin: .3rem 0; }
header table { margin: .5rem 0; }
header p, header ul { margin: .4rem 0; max-width: none; }
nav ol { display: flex; flex-wrap: wrap; gap: .1rem 1rem; padding: .4rem 0 0; margin: .4rem 0 0; list-style: none;
  border-top: 1px solid var(--rule); font-size: .9rem; }
header h2 { margin: .6rem 0 .2rem; padding: 0; border: 0; font-size: 1rem; }
.heat0 { background: var(--heat0); } .heat1 { background: var(--heat1); } .heat2 { background: var(--heat2); }
.heat3 { background: var(--heat3); color: var(--on-heat); } .heat4 { background: var(--heat4); color: var(--on-heat); }
[class*=heat]::before { color: inherit; }
.heat0 a, .heat1 a, .heat2 a, .heat3 a, .heat4 a { color: inherit; }
.bar { display: inline-block; width: 13rem; min-width: 0; height: 1rem; vertical-align: middle; overflow: visible; }
.note td { font-size: .85rem; color: var(--quiet); padding-left: 1.5rem; max-width: 46rem; }
@media print {
  :root { --heat0: #f3f8fc; --heat1: #d3e5f3; --heat2: #9dc6e3; --heat3: #2c70a3; --heat4: #0c3c62; --on-heat: #ffffff; }
  .verdict, .tiles div, td { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
)";
}

}  // namespace grainlaw::app::report
