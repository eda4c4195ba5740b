#include "compare/page.h"

#include "compare/text.h"

#include <fmt/format.h>

namespace touchstone::compare {
namespace {

constexpr const char* style = R"(
:root { color-scheme: light dark; --ink: #1c1e21; --dim: #5c636b; --page: #ffffff; --panel: #f5f6f7; --line: #d9dce0;
  --reference: #1f77b4; --fast: #d35400; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e8ea; --dim: #a2a9b1; --page: #17191c; --panel: #202327; --line: #3a3f45;
    --reference: #6cb2e8; --fast: #ff9650; }
}
body { font: 16px/1.55 system-ui, "Segoe UI", Roboto, sans-serif; color: var(--ink); background: var(--page);
  max-width: 1140px; margin: 0 auto; padding: 2rem 1.5rem 4rem; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .3rem; }
h2 { font-size: 1.25rem; margin: 2.6rem 0 .6rem; padding-top: .6rem; border-top: 1px solid var(--line); }
p { max-width: 46rem; margin: .6rem 0; }
.dim, figcaption { color: var(--dim); }
.verdict p:first-child { font-size: 1.12rem; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(220px, 1fr)); gap: .8rem; margin: 1.4rem 0; }
.tile { background: var(--panel); border-radius: 8px; padding: .8rem 1rem; }
.tile b { display: block; font-size: 1.5rem; font-weight: 600; }
.tile span { color: var(--dim); font-size: .88rem; display: block; }
.reference { color: var(--reference); } .fast { color: var(--fast); }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(480px, 100%), 1fr)); gap: 1.2rem; }
figure { margin: 1rem 0; } figure.wide { grid-column: 1 / -1; } figcaption { font-size: .88rem; max-width: 46rem; }
svg { max-width: 100%; height: auto; display: block; }
.scroll { overflow-x: auto; }
.scroll td:first-child { min-width: 9em; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; margin: .8rem 0; }
th, td { text-align: left; vertical-align: top; padding: .38rem .7rem .38rem 0; border-bottom: 1px solid var(--line); }
th { font-weight: 600; } td.n, th.n { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
td.t { text-align: right; } th.wrap { text-align: right; vertical-align: bottom; } .under { display: block; color: var(--dim); }
a { color: var(--reference); } img { max-width: 100%; height: auto; background: #fff; border-radius: 8px; }
tr.group th { padding-top: 1.1rem; font-size: 1rem; }
code { font: .82rem ui-monospace, "DejaVu Sans Mono", monospace; color: var(--dim); overflow-wrap: anywhere; }
pre { font: .82rem/1.45 ui-monospace, "DejaVu Sans Mono", monospace; background: var(--panel); padding: .9rem 1.1rem;
  border-radius: 8px; overflow-x: auto; white-space: pre-wrap; }
dt { font-weight: 600; } dd { margin: 0 0 .5rem; max-width: 46rem; }
summary { cursor: pointer; font-weight: 600; }
@media print {
  .screen { display: none; } body { max-width: none; padding: 0; font-size: 10.5pt; } figure, tr, .tile { break-inside: avoid; }
  .plots { grid-template-columns: 1fr 1fr; } .tiles { grid-template-columns: repeat(4, 1fr); } h2 { break-after: avoid; }
}
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
  std::string out = "<div class=\"scroll\"><table>\n<tr><th>Part</th><th></th><th>Why</th><th>Cost</th></tr>\n";
  for (const scene::PlanLine& line : plan) {
    out += "<tr>" + cell(line.part) + cell(line.modelled ? "modelled" : "left out") + cell(line.reason) +
           cell(line.cost) + "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string manifest_section(const scene::Manifest& manifest, const std::string& beside) {
  std::string out = tag("h2", "How this was made") + "\n<div class=\"scroll\"><table>\n";
  const auto row = [&](const std::string& name, const std::string& value) {
    out += "<tr>" + tag("th", name) + cell(value) + "</tr>\n";
  };
  row("command", manifest.command);
  row("scene hash", manifest.scene_hash);
  for (const auto& [name, value] : manifest.entries) row(name, value);
  for (const scene::StageTime& time : manifest.times) {
    row("time, " + time.stage,
        fmt::format("{}, of processors {}", quantity_text(time.wall_s, "s"), quantity_text(time.cpu_s, "s")));
  }
  out += "</table></div>\n";
  out += tag("p", beside) + "\n";
  return out + "<details>\n<summary>The scene, every value in force</summary>\n" + tag("pre", manifest.resolved_scene) +
         "\n</details>\n";
}

std::string page(const std::string& title, const std::string& body) {
  std::string out =
      "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n";
  // The browser holds the page to what it promises.
  out +=
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; script-src "
      "'unsafe-inline'; img-src 'self' file: data:\"/>\n";
  out += tag("title", title + " | Touchstone") + "\n<style>" + style + "</style>\n</head>\n<body>\n";
  return out + body + "</body>\n</html>\n";
}

}  // namespace touchstone::compare
