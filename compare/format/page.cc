#include "compare/format/page.h"

#include "compare/format/text.h"

#include <fmt/format.h>

#include <algorithm>

namespace touchstone::compare {
namespace {

// The three-dimensional views keep a light background: their colour maps begin or end near black.
constexpr const char* style = R"(
:root { color-scheme: light dark; --ink: #1c1e21; --dim: #5c636b; --page: #ffffff; --panel: #f4f5f7; --line: #d9dce0;
  --reference: #1f77b4; --fast: #d35400; --plain: #6a51a3; --inclusion: #a03070; --third: #2e8b57; --paper: #ffffff; }
@media screen and (prefers-color-scheme: dark) {
  :root { --ink: #eceef0; --dim: #b3bac2; --page: #1b1e22; --panel: #282c31; --line: #4a5058;
    --reference: #6cb2e8; --fast: #ff9650; --plain: #b9a5ee; --inclusion: #ee86bd; --third: #63c78f; --paper: #f1f2f4; }
}
* { box-sizing: border-box; }
body { font: 16px/1.55 system-ui, "Segoe UI", Roboto, sans-serif; color: var(--ink); background: var(--page);
  max-width: 1240px; margin: 0 auto; padding: 1.6rem 1.5rem 4rem; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .2rem; text-wrap: balance; }
.command { margin: .2rem 0 .6rem; max-width: none; }
h2 { font-size: 1.25rem; margin: 0 0 .6rem; }
body > h2 { margin: 2.2rem 0 .6rem; padding-top: 1.2rem; border-top: 1px solid var(--line); } h3 { font-size: 1.05rem; margin: 1.2rem 0 .4rem; }
body > section { margin-top: 2.2rem; padding-top: 1.2rem; border-top: 1px solid var(--line); }
p { max-width: 46rem; margin: .6rem 0; }
.dim, figcaption { color: var(--dim); }
nav { display: flex; flex-wrap: wrap; gap: .2rem 1.1rem; margin: .5rem 0 1rem; font-size: .9rem; }
.verdict p:first-child { font-size: 1.12rem; } .lead { font-size: 1.12rem; max-width: 60rem; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(200px, 1fr)); gap: .8rem; margin: 1.2rem 0; }
.tile { background: var(--panel); border-radius: 8px; padding: .7rem 1rem; }
.tile b { display: block; font-size: 1.5rem; line-height: 1.35; font-weight: 600; font-variant-numeric: tabular-nums; }
.tile span { color: var(--dim); font-size: .88rem; line-height: 1.4; display: block; }
.first { display: grid; grid-template-columns: minmax(0, 5fr) minmax(0, 6fr); gap: 1.2rem; align-items: start; }
.first > * > :first-child, .first > * > .screen > :first-child { margin-top: 0; }
.reference { color: var(--reference); } .fast { color: var(--fast); }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(480px, 100%), 1fr)); gap: .6rem 1.2rem; }
.bodies { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(300px, 100%), 1fr)); gap: .8rem; }
.bodies svg { background: var(--paper); color: #1c1e21; border-radius: 8px; margin: 0 auto; }
figure { margin: 1rem 0; position: relative; } figure.wide { grid-column: 1 / -1; }
figcaption { font-size: .88rem; max-width: 46rem; margin-top: .3rem; }
svg { max-width: 100%; height: auto; display: block; }
svg [stroke="#1f77b4"] { stroke: var(--reference); } svg [fill="#1f77b4"] { fill: var(--reference); }
svg [stroke="#e4600a"] { stroke: var(--fast); } svg [fill="#e4600a"] { fill: var(--fast); }
svg [stroke="#6a51a3"] { stroke: var(--plain); } svg [fill="#6a51a3"] { fill: var(--plain); }
svg [stroke="#a03070"] { stroke: var(--inclusion); } svg [fill="#a03070"] { fill: var(--inclusion); }
svg [stroke="#2e8b57"] { stroke: var(--third); } svg [fill="#2e8b57"] { fill: var(--third); }
.tip { position: absolute; z-index: 1; pointer-events: none; white-space: pre; font-size: .82rem; line-height: 1.4;
  background: var(--page); color: var(--ink); border: 1px solid var(--line); border-radius: 6px; padding: .3rem .6rem;
  font-variant-numeric: tabular-nums; box-shadow: 0 2px 8px #0003; } .tip[hidden] { display: none; }
.scroll { overflow-x: auto; }
.scroll td:first-child { min-width: 9em; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; margin: .8rem 0; }
th, td { text-align: left; vertical-align: top; padding: .38rem .7rem .38rem 0; border-bottom: 1px solid var(--line); }
th { font-weight: 600; } td.n, th.n { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
th.n { white-space: normal; vertical-align: bottom; } td.t { text-align: right; } th.wrap { text-align: right; vertical-align: bottom; } .under { display: block; color: var(--dim); }
td.any { overflow-wrap: anywhere; }
a { color: var(--reference); } img { max-width: 100%; height: auto; background: #fff; border-radius: 8px; }
tr.group th { padding-top: 1.1rem; font-size: 1rem; }
code { font: .82rem ui-monospace, "DejaVu Sans Mono", monospace; color: var(--dim); overflow-wrap: anywhere; }
pre { font: .82rem/1.45 ui-monospace, "DejaVu Sans Mono", monospace; background: var(--panel); padding: .7rem 1.1rem;
  border-radius: 8px; overflow-x: auto; white-space: pre-wrap; overflow-wrap: anywhere; margin: .4rem 0 1rem; }
dt { font-weight: 600; } dd { margin: 0 0 .5rem; max-width: 46rem; }
summary { cursor: pointer; font-weight: 600; } summary h2 { display: inline; } details > div { margin-top: .6rem; }
@media (max-width: 860px) { .first { grid-template-columns: minmax(0, 1fr); } }
@media (max-width: 480px) {
  body { padding: 1rem .9rem 3rem; } h1 { font-size: 1.35rem; } .lead, .verdict p:first-child { font-size: 1.02rem; }
  .tiles { grid-template-columns: 1fr 1fr; gap: .5rem; } .tile { padding: .5rem .7rem; } .tile b { font-size: 1.2rem; }
  .tile:last-child:nth-child(odd) { grid-column: 1 / -1; }
  .plan tr { display: grid; grid-template-columns: 1fr auto; padding: .4rem 0; border-bottom: 1px solid var(--line); }
  .plan tr:first-child { display: none; } .plan td { border: 0; padding: .1rem 0; }
  .plan td:first-child { font-weight: 600; } .plan td:nth-child(n+3) { grid-column: 1 / -1; } .plan td:nth-child(4) { color: var(--dim); }
}
@media print {
  .screen, nav, .tip { display: none; } .first { grid-template-columns: 1fr; } .bodies { grid-template-columns: repeat(3, 1fr); }
  body { max-width: none; padding: 0; font-size: 10.5pt; } figure, tr, .tile, .bodies svg { break-inside: avoid; }
  .plots { grid-template-columns: 1fr 1fr; } .tiles { grid-template-columns: repeat(auto-fit, minmax(120px, 1fr)); }
  .tile { padding: .5rem .7rem; } .tile b { font-size: 1.15rem; } table { font-size: .8rem; } .scroll { overflow: visible; }
  section:has(> details:not([open])) { display: none; }
  h2, h3 { break-after: avoid; } body > section { margin-top: 1.2rem; padding-top: .6rem; }
}
)";

/// Shows beside the pointer the titles of the nearest markers and of all others at the same x. Without scripts the
/// browser shows the titles.
constexpr const char* values_script = R"(<script>//<![CDATA[
for (const figure of document.querySelectorAll('figure')) {
  const points = [...figure.querySelectorAll('circle > title, rect > title')].map((title) => {
    const mark = title.parentNode, text = title.textContent;
    mark.setAttribute('aria-label', text);
    title.remove();
    return { mark, text };
  });
  if (points.length === 0) continue;
  const tip = document.createElement('div');
  tip.className = 'tip';
  tip.hidden = true;
  figure.append(tip);
  const place = ({ mark }) => {
    const box = mark.getBoundingClientRect();
    return { x: box.x + box.width / 2, y: box.y + box.height / 2, half_x: box.width / 2, half_y: box.height / 2 };
  };
  const show = (event) => {
    let nearest = null, least = 40;
    for (const point of points) {
      const at = place(point), dx = Math.abs(at.x - event.clientX), dy = Math.abs(at.y - event.clientY);
      // Distance from the marker's edge. Inside a marker, or in two at once, the distance from the centre decides.
      const away = Math.hypot(Math.max(0, dx - at.half_x), Math.max(0, dy - at.half_y)) + 1e-3 * Math.hypot(dx, dy);
      if (away < least) [nearest, least] = [{ ...point, at }, away];
    }
    tip.hidden = nearest === null;
    if (tip.hidden) return;
    const plot = nearest.mark.closest('svg');
    const same = points.filter((p) => p.mark.closest('svg') === plot && Math.abs(place(p).x - nearest.at.x) < 0.6);
    tip.textContent = [...new Set(same.map((point) => point.text))].slice(0, 8).join('\n');
    const frame = figure.getBoundingClientRect();
    const left = nearest.at.x - frame.x + 12;
    tip.style.left = `${Math.max(0, Math.min(left, frame.width - tip.offsetWidth))}px`;
    tip.style.top = `${nearest.at.y - frame.y + 14}px`;
  };
  figure.addEventListener('pointermove', show);
  figure.addEventListener('pointerdown', show);
  figure.addEventListener('pointerleave', () => { tip.hidden = true; });
}
//]]></script>
)";

}  // namespace

std::string tag(const std::string& name, const std::string& text, const std::string& attributes) {
  return fmt::format("<{0}{1}>{2}</{0}>", name, attributes.empty() ? "" : " " + attributes, escape_xml(text));
}

std::string cell(const std::string& text) { return tag("td", text); }
std::string number_cell(const std::string& text) { return tag("td", text, "class=\"n\""); }

std::string figure(const std::string& svg, const std::string& caption, bool wide) {
  return fmt::format("<figure{}>\n{}{}</figure>\n", wide ? " class=\"wide\"" : "", svg,
                     caption.empty() ? "" : tag("figcaption", caption) + "\n");
}

std::string tile(const std::string& what, const std::string& number, const std::string& note) {
  return fmt::format("<div class=\"tile\">{}{}{}</div>\n", tag("span", what), tag("b", number), tag("span", note));
}

std::string scene_title(const scene::Scene& scene) { return scene.title.empty() ? scene.name : scene.title; }

std::string plan_table(const scene::Plan& plan) {
  std::string out =
      "<div class=\"scroll\"><table class=\"plan\">\n<tr><th>Part</th><th></th><th>Why</th><th>Cost</th></tr>\n";
  for (const scene::PlanLine& line : plan) {
    out += "<tr>" + cell(line.part) + cell(line.modelled ? "modelled" : "left out") + cell(line.reason) +
           cell(line.cost) + "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string contents(const std::vector<Section>& sections) {
  std::string out = "<nav>";
  for (const Section& one : sections) {
    if (!one.body.empty()) out += tag("a", one.title, fmt::format("href=\"#{}\"", slug(one.title))) + " ";
  }
  return out + "</nav>\n";
}

std::string in_order(const std::vector<Section>& sections) {
  std::string out;
  for (const Section& one : sections) {
    if (one.body.empty()) continue;
    // The link leads to the content of a folded section, so that a browser opens it.
    out += one.folded
               ? fmt::format("<section>\n<details>\n<summary>{}</summary>\n<div id=\"{}\">\n{}</div>\n</details>\n",
                             tag("h2", one.title), slug(one.title), one.body)
               : fmt::format("<section id=\"{}\">\n{}\n{}", slug(one.title), tag("h2", one.title), one.body);
    out += "</section>\n";
  }
  return out;
}

std::string origin_rows(const scene::Manifest& manifest) {
  const auto row = [](const std::string& name, const std::string& value) {
    return "<tr>" + tag("th", name) + cell(value) + "</tr>\n";
  };
  std::string out = row("command", manifest.command);
  for (const auto& [name, value] : manifest.entries) out += row(name, value);
  for (const scene::StageTime& time : manifest.times)
    out += row("time, " + time.stage, quantity_text(time.wall_s, "s"));
  return out;
}

Section origin(const scene::Manifest& manifest, const std::string& beside) {
  std::string out = "<div class=\"scroll\"><table>\n";
  const auto row = [&](const std::string& name, const std::string& value) {
    out += "<tr>" + tag("th", name) + tag("td", value, "class=\"any\"") + "</tr>\n";
  };
  row("command", manifest.command);
  row("scene hash", manifest.scene_hash);
  for (auto [name, value] : manifest.entries) {
    std::replace(name.begin(), name.end(), '_', ' ');
    row(name, value);
  }
  for (const scene::StageTime& time : manifest.times) {
    row("time, " + time.stage,
        fmt::format("{}, of processors {}", quantity_text(time.wall_s, "s"), quantity_text(time.cpu_s, "s")));
  }
  return {"How this was made", out + "</table></div>\n" + tag("p", beside) + "\n"};
}

Section resolved_scene(const scene::Manifest& manifest) {
  return {"Settings",
          tag("p", "The scene with every value in force, as a scene file.", "class=\"dim\"") + "\n" +
              tag("pre", manifest.resolved_scene) + "\n",
          true};
}

std::string manifest_section(const scene::Manifest& manifest, const std::string& beside) {
  return in_order({origin(manifest, beside), resolved_scene(manifest)});
}

std::string page(const std::string& title, const std::string& body) {
  std::string out =
      "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n";
  // The browser enforces that the page loads nothing from elsewhere.
  out +=
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
      "script-src "
      "'unsafe-inline'; img-src 'self' file: data:\"/>\n";
  out += tag("title", title + " | Touchstone") + "\n<style>" + style + "</style>\n</head>\n<body>\n";
  const bool plots = body.find("<figure") != std::string::npos;
  return out + body + (plots ? values_script : "") + "</body>\n</html>\n";
}

}  // namespace touchstone::compare
