// SPDX-License-Identifier: Apache-2.0
#include "cli/report/page_style.h"

namespace rsstab::report {

std::string_view PageStyle() {
  return R"(*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);line-height:1.5;font-size:15px;
font-family:system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;
-webkit-text-size-adjust:100%}
main{max-width:1020px;margin:0 auto;padding:28px 18px 56px}
header{border-bottom:2px solid var(--ink);padding-bottom:14px}
.kind{margin:0;color:var(--faint);font-size:13px;letter-spacing:.02em}
h1{margin:2px 0 0;font-size:26px;line-height:1.2;font-weight:650;overflow-wrap:anywhere}
.sub{margin:6px 0 0;color:var(--faint)}
section{margin-top:40px}
h2{margin:0;font-size:18px;font-weight:650;padding-bottom:6px;border-bottom:1px solid var(--grid)}
h3{margin:26px 0 0;font-size:15px;font-weight:600}
section>p{margin:10px 0 0;max-width:70ch;color:var(--faint)}
.big{display:grid;grid-template-columns:repeat(auto-fill,minmax(176px,1fr));gap:20px 14px;
margin:22px 0 0}
.big div{border-left:3px solid var(--line-2);padding-left:10px}
.big dt{color:var(--faint);font-size:13px}
.big dd{margin:0;font-size:20px;font-weight:650;line-height:1.3;font-variant-numeric:tabular-nums;
white-space:nowrap}
.big dd small{font-size:14px;font-weight:400;color:var(--faint)}
.big .was{font-weight:400;color:var(--line-1)}
@media(max-width:420px){.big{grid-template-columns:repeat(2,minmax(0,1fr))}.big dd{font-size:17px}}
.wide{overflow-x:auto;margin-top:14px}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;min-width:min(100%,420px)}
caption{text-align:left;font-weight:600;padding-bottom:6px}caption span{position:sticky;left:0}
th,td{padding:5px 14px 5px 0;text-align:left;border-bottom:1px solid var(--grid);
vertical-align:baseline}
thead th{color:var(--faint);font-weight:500;font-size:13px;white-space:nowrap;
border-bottom-color:var(--faint)}
tbody th{font-weight:400;overflow-wrap:anywhere;min-width:7.5em}
.wide thead th:first-child,.wide tbody th{position:sticky;left:0;background:var(--paper)}
@media(max-width:640px){table{font-size:14px}th,td{padding-right:8px}}
.note{color:var(--faint);padding-left:8px}
@media(max-width:640px){.note{display:none}}
.n{text-align:right;white-space:nowrap;padding-left:8px}
td.best{font-weight:650}
.facts{display:grid;grid-template-columns:minmax(110px,auto) 1fr;gap:5px 20px;margin:14px 0 0}
.facts dt{color:var(--faint)}.facts dd{margin:0;overflow-wrap:anywhere}
.charts{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,330px),1fr));
gap:26px 34px;margin-top:18px}
.charts .chart{width:100%}
.slides{display:grid;grid-template-columns:repeat(2,minmax(0,1fr));gap:22px;margin-top:16px}
.slides>:first-child{grid-column:1/-1}.slides>:only-child{max-width:720px}
.slides>:first-child:nth-last-child(2){grid-column:auto}
@media(max-width:640px){.slides{grid-template-columns:minmax(0,1fr)}}
figure{margin:0}
figcaption{overflow-wrap:anywhere;margin-top:6px;font-size:14px;color:var(--faint)}
figcaption b{color:var(--ink);font-weight:600}
.stage{position:relative;overflow:hidden;border-radius:3px;background:var(--grid);
touch-action:pan-y;cursor:ew-resize;user-select:none;-webkit-user-select:none}
.stage img{position:absolute;inset:0;width:100%;height:100%;display:block;pointer-events:none}
.stage .over{clip-path:inset(0 calc(100% - var(--split,50%)) 0 0)}
.stage i{position:absolute;top:0;bottom:0;left:var(--split,50%);width:2px;margin-left:-1px;
background:#fff;box-shadow:0 0 3px #000a;pointer-events:none}
.stage i:after{content:"\2039\00a0\203a";position:absolute;top:50%;left:50%;width:34px;height:34px;
margin:-17px;border-radius:50%;background:#fff;color:#1b1f24;box-shadow:0 1px 4px #0008;
font:600 17px/31px system-ui,sans-serif;text-align:center}
.stage span{position:absolute;bottom:8px;padding:1px 8px;border-radius:3px;background:#000a;
color:#fff;font-size:12px;pointer-events:none}
.stage span:first-of-type{left:8px}.stage span:last-of-type{right:8px}
.stage input{position:absolute;inset:0;width:100%;height:100%;margin:0;opacity:0;
pointer-events:none}
.stage input:focus-visible~i:after{outline:3px solid var(--line-2)}
.panels{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));
gap:18px 20px;margin-top:22px}
.pairs{grid-template-columns:repeat(2,minmax(0,1fr))}
.gallery{grid-template-columns:repeat(4,minmax(0,1fr));gap:14px 16px}
@media(max-width:640px){.gallery{grid-template-columns:repeat(2,minmax(0,1fr));gap:12px 10px}}
.panels img{box-shadow:0 0 0 1px var(--grid);display:block;width:100%;height:auto;border-radius:3px}
.keys{display:flex;flex-wrap:wrap;gap:14px 40px;align-items:center;margin-top:14px;font-size:13px;
color:var(--faint)}
.keys>div{display:flex;align-items:center;gap:12px}
.keys .wheel{width:84px;height:84px;border-radius:50%;box-shadow:0 0 0 1px var(--grid)}
.keys .ramp{width:min(220px,40vw);height:12px;border-radius:2px}
.bars{display:grid;grid-template-columns:minmax(90px,auto) 1fr auto;gap:5px 14px;margin:14px 0 0;
align-items:center;font-variant-numeric:tabular-nums}
.bars>div{display:contents}
@media(max-width:640px){.bars{display:block}.bars>div{display:grid;gap:2px 14px;
grid-template:"name time" "bar bar"/1fr auto;margin-bottom:8px}.bars b{grid-area:bar}}
.bars b{display:block;height:11px;background:var(--line-2);opacity:.75;border-radius:2px;
min-width:1px}
.bars em{font-style:normal;text-align:right;white-space:nowrap;color:var(--faint)}
details{margin-top:14px}summary{cursor:pointer}
footer{margin-top:48px;padding-top:10px;border-top:1px solid var(--grid);color:var(--faint);
font-size:13px}
code{font:13px ui-monospace,"SF Mono",Menlo,"DejaVu Sans Mono",monospace;overflow-wrap:anywhere}
@media print{section{break-inside:avoid}}
)";
}

std::string_view PageScript() {
  return R"(for (const stage of document.querySelectorAll('.stage')) {
  const range = stage.querySelector('input');
  const show = () => stage.style.setProperty('--split', range.value + '%');
  const follow = (event) => {
    const box = stage.getBoundingClientRect();
    range.value = 100 * (event.clientX - box.left) / box.width;
    show();
  };
  stage.addEventListener('pointerdown', (event) => {
    stage.setPointerCapture(event.pointerId);
    range.focus({preventScroll: true});
    follow(event);
  });
  stage.addEventListener('pointermove', (event) => {
    if (stage.hasPointerCapture(event.pointerId)) follow(event);
  });
  range.addEventListener('input', show);
  show();
}
)";
}

}  // namespace rsstab::report
