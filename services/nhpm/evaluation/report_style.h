#pragma once

namespace conav::nhpm {

/// The page's style sheet: colours by prefers-color-scheme, nothing from elsewhere. Add and remove
/// are blue and vermilion of Okabe and Ito's palette, which colour-blind people tell apart.
inline constexpr const char* kPageStyle = R"css(
:root { color-scheme: light dark; --paper: #ffffff; --ink: #1c1c1c; --muted: #5a5a5a;
  --rule: #d8d8d8; --wall: #4a4a4a; --faint-wall: #bdbdbd; --free: #f1f1f1; --seen: #ffe9a8;
  --add: #0072b2; --remove: #d55e00; --camera: #117a3d; --good: #117a3d; --bad: #b00020; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #16181c; --ink: #ececec; --muted: #a9a9a9; --rule: #3a3d44; --wall: #b9bcc4;
    --faint-wall: #565a63; --free: #26292f; --seen: #6b5a1e; --add: #56b4e9; --remove: #ff8a3d;
    --camera: #5fd38d; --good: #5fd38d; --bad: #ff7b8a; } }
body { margin: 2rem auto; max-width: 76rem; padding: 0 1rem; background: var(--paper);
  color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
h1, h2, h3 { line-height: 1.2; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 0.3rem 0.7rem; border-bottom: 1px solid var(--rule); text-align: right; }
th:first-child, td:first-child, td.text { text-align: left; }
.muted, figcaption { color: var(--muted); font-size: 0.9rem; }
.origin { display: inline-block; padding: 0.1rem 0.6rem; border: 2px solid var(--remove);
  border-radius: 0.4rem; font-weight: 600; }
.pass { color: var(--good); font-weight: 600; }
.fail { color: var(--bad); font-weight: 600; }
.row { display: flex; flex-wrap: wrap; gap: 1rem; }
figure { margin: 0; max-width: 18rem; }
svg { max-width: 100%; height: auto; display: block; }
.rule { stroke: var(--rule); } .ideal { stroke: var(--muted); stroke-dasharray: 5 4; }
.tick, .label { fill: var(--muted); font-size: 11px; } .label { font-size: 12px; }
.curve { stroke: var(--add); stroke-width: 2; } .dot { fill: var(--add); }
.wall { fill: var(--wall); } .faint-wall { fill: var(--faint-wall); } .free { fill: var(--free); }
.seen-free { fill: var(--seen); } .seen-wall { fill: var(--wall); stroke: var(--remove); }
.path { stroke: var(--add); stroke-width: 3; } .camera { fill: var(--camera); }
.add { fill: var(--add); } .remove { fill: var(--remove); }
.percent { fill: var(--ink); font-size: 9px; } .sign { fill: var(--paper); font-size: 17px; }
)css";

}  // namespace conav::nhpm
