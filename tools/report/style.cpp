#include "tools/report/style.h"

namespace scenegen::tools {

namespace {

constexpr std::string_view kStyle = R"css(:root {
  color-scheme: light dark;
  --paper: #fff; --text: #1b1f24; --muted: #59616b; --line: #d9dde2; --soft: #f4f6f8; --link: #1d5fb0;
  --better: #1a7a45; --worse: #b23b12; --level: #6a7078; --shade: #0004;
  --s0: #1f63b5; --s1: #c8590f; --s2: #16806a; --s3: #a5348f; --s4: #86690f; --s5: #5a4fcf; --s6: #4a7484; --s7: #8c4a4a;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #14171b; --text: #e4e7eb; --muted: #a0a8b2; --line: #363c44; --soft: #1d2126; --link: #7fb2f0;
    --better: #5cc98a; --worse: #f08a5d; --level: #a0a8b2; --shade: #000c;
    --s0: #6ea8f0; --s1: #f09a5a; --s2: #4fc3a8; --s3: #e080cc; --s4: #d0b050; --s5: #a79df7; --s6: #8fbccc; --s7: #d99090;
  }
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; text-size-adjust: 100%; }
body {
  margin: 0 auto; padding: 2.5rem 1.25rem 3rem; max-width: 70rem; background: var(--paper); color: var(--text);
  font: 1rem/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "Liberation Sans", Arial, sans-serif;
  overflow-wrap: break-word;
}
h1, h2, h3 { line-height: 1.2; letter-spacing: -0.012em; text-wrap: balance; }
h1 { font-size: 2rem; margin: 0 0 0.75rem; }
h2 { font-size: 1.45rem; margin: 0 0 1rem; }
h3 { font-size: 1.15rem; margin: 0 0 0.5rem; }
p { margin: 0 0 0.75rem; max-width: 44rem; }
a { color: var(--link); text-decoration-thickness: 1px; text-underline-offset: 0.15em; }
header, main > section { border-bottom: 1px solid var(--line); padding-bottom: 1.5rem; margin-bottom: 2rem; }
nav ul { display: flex; flex-wrap: wrap; gap: 0.25rem 1.25rem; list-style: none; margin: 0; padding: 0; }
.run > section { padding-top: 1.5rem; margin-top: 1.75rem; border-top: 1px solid var(--line); }
.lead { font-size: 1.09rem; }
.note { color: var(--muted); font-size: 0.875rem; margin: 0.5rem 0 0; }
.sr { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap; }
footer { color: var(--muted); font-size: 0.875rem; }

.headline { font-size: 1.2rem; line-height: 1.4; max-width: none; margin: 1.5rem 0 0.6rem; }
h2 + .headline { margin-top: 0; }
.bar { display: flex; gap: 2px; height: 0.6rem; margin-bottom: 1.25rem; border-radius: 0.3rem; overflow: hidden; }
.bar span { min-width: 3px; }
.bar .better { background: var(--better); } .bar .level { background: var(--level); opacity: 0.5; }
.bar .worse { background: var(--worse); }
.glance {
  display: grid; grid-template-columns: minmax(0, 1fr) 300px; gap: 0 2rem; padding: 0.9rem 0;
  border-top: 1px solid var(--line); break-inside: avoid;
}
.glance h3 { font-size: 1rem; margin-bottom: 0.2rem; }
.glance p { margin: 0; font-size: 0.9375rem; }
.strip { display: block; width: 300px; max-width: 100%; height: auto; overflow: visible; }
.strip .better, .strip .level { stroke: var(--paper); stroke-width: 0.8; }
.strip .better { fill: var(--better); } .strip .level { fill: var(--level); }
.strip .worse { stroke: var(--worse); stroke-width: 1.8; fill: none; }
.glance .counts { font-size: 0.875rem; display: flex; flex-wrap: wrap; gap: 0 0.75rem; font-variant-numeric: tabular-nums; }
.better, .worse, .level { font-weight: 600; }
.better { color: var(--better); } .worse { color: var(--worse); } .level { color: var(--level); }
.typical { color: var(--muted); }

.failures { border: 1px dashed var(--worse); border-radius: 0.4rem; padding: 0.6rem 1rem; margin: 1rem 0; font-size: 0.9375rem; break-inside: avoid; }
.failures p { margin: 0; } .failures strong { color: var(--worse); }
.failures ul { margin: 0.25rem 0 0; padding-left: 1.1rem; } .failures li { overflow-wrap: anywhere; } .failures .case { font-weight: 600; }

.verdicts { margin: 0 0 1.25rem; width: 100%; border: 1px solid var(--line); border-radius: 0.4rem; }
.verdicts th, .verdicts td { padding: 0.35rem 0.6rem; position: static; }
.verdicts tbody th { font-weight: 600; white-space: nowrap; } .verdicts .ours { font-weight: 600; }
.verdicts td { overflow-wrap: anywhere; min-width: 6.5rem; } .verdicts td:nth-child(2) { min-width: 11rem; } .verdicts td:last-child { min-width: 16rem; }
.verdicts .group th { background: var(--soft); padding-top: 0.6rem; font-size: 0.9375rem; }
.verdicts .key { display: none; } .verdicts tr { break-inside: avoid; }

.facts { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 18rem), 1fr)); gap: 0.35rem 1.5rem; margin: 0; font-size: 0.875rem; }
.facts div { display: flex; gap: 0.6rem; min-width: 0; }
.facts .long { grid-column: 1 / -1; }
.facts dt { color: var(--muted); flex: none; }
.facts dd { margin: 0; min-width: 0; overflow-wrap: anywhere; }

figure { margin: 1.75rem 0 0; }
figcaption { font-weight: 600; margin-bottom: 0.5rem; }
/* What is moved out of sight inside must not widen the page; a shade says that a table goes on. */
.scroll {
  position: relative; overflow: auto; max-height: 36rem; border: 1px solid var(--line); border-radius: 0.4rem; width: fit-content; max-width: 100%;
  background:
    linear-gradient(to right, var(--paper) 40%, transparent) left / 3rem 100% no-repeat local,
    linear-gradient(to left, var(--paper) 40%, transparent) right / 3rem 100% no-repeat local,
    linear-gradient(to right, var(--shade), transparent) left / 0.9rem 100% no-repeat scroll,
    linear-gradient(to left, var(--shade), transparent) right / 0.9rem 100% no-repeat scroll;
}
.scroll:focus-visible { outline: 2px solid var(--link); outline-offset: 1px; }
table { border-collapse: separate; border-spacing: 0; font-size: 0.875rem; line-height: 1.35; font-variant-numeric: tabular-nums lining-nums; }
th, td { padding: 0.35rem 0.7rem; text-align: left; vertical-align: baseline; }
tbody tr + tr > * { border-top: 1px solid var(--line); }
thead th { position: sticky; top: 0; z-index: 1; background: var(--soft); vertical-align: bottom; border-bottom: 1px solid var(--line); font-weight: 600; }
tbody th { font-weight: 400; position: sticky; left: 0; background: var(--paper); }
thead th:first-child { left: 0; z-index: 2; }
.n { text-align: right; white-space: nowrap; }
thead .n { white-space: normal; }
.s { white-space: nowrap; } .w { min-width: 10rem; }
.unit { color: var(--muted); font-weight: 400; white-space: nowrap; }
td.paper { color: var(--muted); font-style: italic; }
thead th.paper { font-style: italic; }
.tag {
  display: inline-block; font: normal 400 0.6875rem/1.3 system-ui, sans-serif; letter-spacing: 0.02em; color: var(--muted);
  border: 1px dashed currentColor; border-radius: 0.2rem; padding: 0 0.25rem; white-space: nowrap;
}
.mark { display: inline-block; width: 4.1rem; padding-left: 0.5rem; text-align: left; font-size: 0.8125rem; white-space: nowrap; }

svg text { font-family: system-ui, -apple-system, "Segoe UI", Roboto, "Liberation Sans", Arial, sans-serif; font-size: 13px; fill: var(--text); font-variant-numeric: tabular-nums; }
svg .tick, svg .axis-title { fill: var(--muted); }
.strip text { font-size: 12px; }
.middle { text-anchor: middle; } .end { text-anchor: end; }
.grid { stroke: var(--line); fill: none; } .axis { stroke: var(--muted); fill: none; }
svg.chart { display: block; width: 100%; max-width: 760px; height: auto; }
svg.slim { display: none; max-width: 480px; }
.line { fill: none; stroke-width: 2; stroke-linejoin: round; stroke-linecap: round; }
.line.paper { stroke-dasharray: 5 5; stroke-width: 1.6; }
.marker { stroke-width: 1.5; }
.whisker { fill: none; stroke-width: 1.2; }
.band { stroke: none; opacity: 0.16; }
.band.paper { opacity: 0.08; }
.s0 { stroke: var(--s0); fill: var(--s0); } .s1 { stroke: var(--s1); fill: var(--s1); }
.s2 { stroke: var(--s2); fill: var(--s2); } .s3 { stroke: var(--s3); fill: var(--s3); }
.s4 { stroke: var(--s4); fill: var(--s4); } .s5 { stroke: var(--s5); fill: var(--s5); }
.s6 { stroke: var(--s6); fill: var(--s6); } .s7 { stroke: var(--s7); fill: var(--s7); }
path.line, path.whisker { fill: none; } path.band { stroke: none; } path.marker.paper { fill: var(--paper); }
.legend { display: flex; flex-wrap: wrap; gap: 0.15rem 1.25rem; list-style: none; margin: 0 0 0.5rem; padding: 0; font-size: 0.875rem; }
.legend li { display: flex; align-items: center; gap: 0.4rem; }
.swatch { width: 34px; height: 14px; flex: none; }
details { margin-top: 0.5rem; font-size: 0.875rem; }
summary { color: var(--muted); cursor: pointer; width: fit-content; }
details .scroll { margin-top: 0.5rem; max-height: 24rem; }
.picture img { display: block; max-width: 100%; height: auto; border-radius: 0.4rem; border: 1px solid var(--line); }
.missing { border: 1px dashed var(--worse); color: var(--worse); border-radius: 0.4rem; padding: 0.75rem 1rem; }

@media (max-width: 640px) {
  body { padding: 1.5rem 1rem 2rem; }
  h1 { font-size: 1.55rem; }
  .glance { grid-template-columns: minmax(0, 1fr); gap: 0.6rem; }
  th, td { padding: 0.35rem 0.5rem; }
  tbody th, tbody th.s { max-width: 9rem; white-space: normal; min-width: 0; }
  svg.broad { display: none; } svg.slim { display: block; }
  .verdicts, .verdicts tbody, .verdicts tr, .verdicts th, .verdicts td { display: block; min-width: 0; max-width: none; }
  .verdicts { border: 0; } .verdicts thead { display: none; }
  .verdicts tr { border: 1px solid var(--line); border-radius: 0.4rem; padding: 0.5rem 0.75rem; margin-bottom: 0.6rem; }
  .verdicts tbody th, .verdicts tbody td { border: 0; padding: 0.05rem 0; }
  .verdicts td.paper, .verdicts td.ours, .verdicts td.s { display: inline-block; margin-right: 1rem; }
  .verdicts tr.group { border: 0; padding: 0; margin: 1.25rem 0 0.5rem; } .verdicts .group th { background: none; padding: 0; }
  .verdicts .key { display: inline; color: var(--muted); font-weight: 400; font-style: normal; }
}
@media print {
  @page { margin: 16mm 14mm; }
  :root {
    color-scheme: light;
    --paper: #fff; --text: #000; --muted: #444; --line: #bbb; --soft: #f1f1f1; --link: #000;
    --better: #1a7a45; --worse: #b23b12; --level: #6a7078;
    --s0: #1f63b5; --s1: #c8590f; --s2: #16806a; --s3: #a5348f; --s4: #86690f; --s5: #5a4fcf; --s6: #4a7484; --s7: #8c4a4a;
  }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  html { font-size: 10pt; }
  body { padding: 0; max-width: none; }
  nav, details { display: none; }
  a { text-decoration: none; color: inherit; }
  h1, h2, h3, figcaption, .lead, .legend { break-after: avoid; }
  figure.chart, figure.picture, .glance, .headline, tr { break-inside: avoid; }
  .scroll { overflow: visible; max-height: none; width: auto; border: none; background: none; }
  thead { display: table-header-group; }
  thead th, tbody th { position: static; }
  table.wide { font-size: 7pt; } table.wide th, table.wide td { padding: 0.2rem 0.3rem; }
  svg.chart.broad { display: block; max-width: 150mm; } svg.chart.slim { display: none; }
  .picture img { max-height: 120mm; width: auto; }
}
)css";

}  // namespace

std::string_view report_style() {
  return kStyle;
}

}  // namespace scenegen::tools
