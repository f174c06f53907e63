// SPDX-License-Identifier: BSD-3-Clause
// The style sheet of a report. The document that it is in is html_document.h.
#pragma once

namespace raven_correction {

inline constexpr char kHtmlStyle[] = R"(
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.2rem; max-width: 1120px; background: #fff; color: #1c1c1c;
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0.4rem 0 0.2rem; }
h2 { font-size: 1.25rem; margin: 2.4rem 0 0.6rem; padding-top: 0.6rem; border-top: 2px solid #d4d4d4; }
p, ul, ol { max-width: 75ch; }
.subtitle { color: #555; margin: 0 0 1rem; }
nav ul { list-style: none; padding: 0; max-width: none; margin: 1rem 0; display: flex; flex-wrap: wrap; gap: 0.3rem 1.1rem; }
a { color: #00558a; }
.verdict { border: 1px solid #bbb; border-left: 8px solid #555; border-radius: 4px; padding: 0.8rem 1.2rem; margin: 1rem 0; background: #fafafa; }
.verdict h2 { border: 0; padding: 0; margin: 0 0 0.4rem; font-size: 1.25rem; }
.verdict h3 { font-size: 1rem; margin: 0.9rem 0 0.2rem; }
.verdict ul, .verdict ol { margin: 0.2rem 0; padding-left: 1.4rem; max-width: none; }
.good { border-left-color: #009e73; }
.notice { border-left-color: #0072b2; }
.warning { border-left-color: #d55e00; border-left-style: double; }
.sign { font-weight: 700; }
.note { border-left: 6px solid #0072b2; padding: 0.3rem 0.9rem; background: #f6f6f6; max-width: 80ch; }
.note.warning { border-left: 8px double #d55e00; }
.note.good { border-left-color: #009e73; }
.numbers { display: grid; grid-template-columns: repeat(auto-fit, minmax(190px, 1fr)); gap: 0.7rem; margin: 1rem 0; padding: 0; }
.numbers div { border: 1px solid #ccc; border-radius: 4px; padding: 0.5rem 0.8rem; }
.numbers dt { color: #555; font-size: 0.85rem; }
.numbers dd { margin: 0; font-size: 1.15rem; font-weight: 600; }
.numbers dd.detail { font-size: 0.85rem; font-weight: 400; color: #555; }
.scroll { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; font-size: 0.9rem; }
caption { text-align: left; padding: 0.2rem 0 0.5rem; color: #333; caption-side: top; }
th, td { padding: 0.25rem 0.7rem; text-align: left; border-bottom: 1px solid #ddd; vertical-align: top; }
thead th { border-bottom: 2px solid #555; vertical-align: bottom; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr.emphasised td { font-weight: 700; background: #f2f2f2; }
figure { margin: 1.4rem 0; }
figcaption { font-size: 0.9rem; color: #333; max-width: 90ch; margin-top: 0.4rem; }
.panels { display: grid; gap: 0.8rem; grid-template-columns: 1fr; }
.panels svg { width: 100%; height: auto; max-width: 600px; }
.legend { list-style: none; margin: 0 0 0.4rem; padding: 0; max-width: none; display: flex; flex-wrap: wrap; gap: 0.2rem 1.2rem; font-size: 0.88rem; }
.legend svg { vertical-align: -1px; }
pre { background: #f4f4f4; border: 1px solid #ddd; border-radius: 4px; padding: 0.7rem 0.9rem; font-size: 0.82rem;
  line-height: 1.4; white-space: pre-wrap; overflow-wrap: anywhere; }
td { overflow-wrap: break-word; }
footer { margin-top: 3rem; border-top: 1px solid #ccc; color: #666; font-size: 0.85rem; }
@media (min-width: 560px) { .columns-2, .columns-4 { grid-template-columns: repeat(2, 1fr); } }
@media (min-width: 980px) { .columns-4 { grid-template-columns: repeat(4, 1fr); } }
@media (max-width: 560px) { body { padding: 0.7rem; font-size: 15px; } h1 { font-size: 1.35rem; }
  th, td { padding: 0.2rem 0.45rem; } .verdict { padding: 0.6rem 0.8rem; } }
@media print {
  @page { margin: 14mm; }
  body { max-width: none; padding: 0; font-size: 10pt; }
  nav { display: none; }
  a { color: inherit; text-decoration: none; }
  .columns-2, .columns-4 { grid-template-columns: repeat(2, 1fr); }
  .panels svg, tr, .verdict, .note, .numbers div { break-inside: avoid; }
  h2, .legend, caption { break-after: avoid; }
  figcaption { break-before: avoid; }
  .scroll { overflow: visible; }
  table { font-size: 8pt; }
  pre { font-size: 7.5pt; }
}
)";

}  // namespace raven_correction
