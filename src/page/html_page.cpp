// SPDX-License-Identifier: MIT
#include "ripplenotch/page/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

namespace {

// Light or dark by the reader's system setting; print is light.
constexpr std::string_view page_style = R"css(
:root { color-scheme: light dark; --ink: #1b1b1b; --paper: #fff; --soft: #4a5056; --rule: #d3d7db;
  --box: #f3f5f7; --link: #0b5394; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e6e8; --paper: #14171a; --soft: #aab1b8; --rule: #3a4047; --box: #1e2328; --link: #7cc0f4; }
  figure img { filter: invert(.92) hue-rotate(180deg); }
}
body { font: 16px/1.45 system-ui, sans-serif; color: var(--ink); background: var(--paper); margin: 0 auto;
  max-width: 92rem; padding: 1rem; overflow-wrap: anywhere; }
.summary, p, figcaption, pre, dl { max-width: 62rem; }
h1 { font-size: 1.5rem; margin: .2rem 0 1rem; }
h2 { font-size: 1.15rem; margin: 0 0 .4rem; }
section { border-top: 1px solid var(--rule); margin-top: 2.2rem; padding-top: 1rem; }
h3 { font-size: 1rem; margin: 1.2rem 0 .2rem; }
a { color: var(--link); text-decoration: none; }
a:hover { text-decoration: underline; }
.summary article { background: var(--box); border-radius: .5rem; padding: .8rem 1rem; margin: 0 0 .8rem; }
.summary h2 { font-size: 1rem; }
.good { border-left: .4rem solid #2e7d32; } .doubtful { border-left: .4rem solid #b26a00; }
.bad { border-left: .4rem solid #c62828; }
.state { border: 1px solid var(--soft); border-radius: .3rem; color: var(--soft); font-size: .8rem;
  font-weight: 400; padding: 0 .4rem; }
.summary p { font-weight: 600; margin: .2rem 0 .6rem; }
.summary .facts { margin: 0; }
nav h2 { margin-top: 1.4rem; }
nav ol { margin: 0; padding-left: 1.5rem; }
.lead + nav { margin-top: 1rem; } .lead + nav h2 { display: none; }
.lead + nav ol { display: flex; flex-wrap: wrap; gap: .3rem 1.2rem; list-style: none; padding: 0; }
.verdict { font-size: 1.1rem; font-weight: 600; margin: .3rem 0 1rem; }
.facts { display: flex; flex-wrap: wrap; gap: .6rem; margin: 0 0 1rem; padding: 0; list-style: none; }
.facts li { border: 1px solid var(--rule); border-radius: .4rem; padding: .3rem .7rem; }
.facts b { display: block; font-size: 1.05rem; }
.facts span, .note, figcaption, dl { color: var(--soft); font-size: .9rem; }
.answer { background: var(--box); border-radius: .3rem; padding: .6rem .8rem; }
.lead:first-of-type { border-top: 0; margin-top: 0; padding-top: 0; }
.command { display: flex; gap: .5rem; align-items: start; max-width: 62rem; }
.command pre { flex: 1; margin: .25rem 0; }
.command button { font: inherit; font-size: .85rem; color: var(--link); background: var(--box); cursor: pointer;
  border: 1px solid var(--rule); border-radius: .3rem; margin: .25rem 0; padding: .5rem .7rem; min-width: 5rem; }
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
  body { max-width: none; padding: 0; font-size: 11pt; } details, .modebar, .command button, nav { display: none; }
  .scroll { overflow: visible; } table { font-size: 8pt; } th, td { padding: .1rem .25rem; }
  .plot, figure img { max-width: 100%; }
  figure, table, article { break-inside: avoid; } figure img { filter: none; } }
)css";

// The figures come in the colours of paper; in dark mode each of these has another of the same contrast.
// White names on a heat map stay white, since the map stays as it is.
constexpr std::string_view page_script = R"js(
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
  if (light) figure.layout.width = 690;
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
// A page of paper is narrower than the window.
addEventListener("beforeprint", () => draw_all(true));
addEventListener("afterprint", () => draw_all(false));
)js";

// Copies a command; where the page may not, the command is selected.
constexpr std::string_view copy_script = R"js(
document.addEventListener("click", (event) => {
  const line = event.target.matches(".command button") && event.target.previousElementSibling;
  if (!line) return;
  getSelection().selectAllChildren(line);
  const said = (word) => { event.target.textContent = word; };
  if (navigator.clipboard) navigator.clipboard.writeText(line.textContent).then(() => said("copied"), () => said("selected"));
  else said(document.execCommand("copy") ? "copied" : "selected");
});
)js";

std::string base64(std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned block = 0;
        for (std::size_t k = 0; k < 3; ++k)
            block = (block << 8U) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k)
            text +=
                i + k <= bytes.size() ? digits[(block >> (18U - 6U * static_cast<unsigned>(k))) & 63U] : '=';
    }
    return text;
}

bool is_number(std::string_view cell) {
    return cell == "-" ||
           (!cell.empty() && cell.find_first_not_of("0123456789+-.e, ") == std::string_view::npos);
}

// As a content security policy names a script.
std::string script_hash(std::string_view script) {
    Sha256 hash;
    hash.update(script);
    const std::string hex = hash.hex();
    std::string bytes;
    for (std::size_t i = 0; i < hex.size(); i += 2)
        bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
    return "'sha256-" + base64(bytes) + "'";
}

class Writer {
  public:
    Writer(const Page& page, const std::optional<std::string>& plotly_js) {
        for (const PageSection& one : page.sections)
            for (const Figure& drawn : one.figures)
                pictured_ = pictured_ || std::any_of(drawn.panels.begin(), drawn.panels.end(), shows);
        if (pictured_) plotly_js_ = plotly_js;
    }

    [[nodiscard]] std::string written(const Page& page) {
        head(page);
        put("<h1>{}</h1>\n", shown(page.title));
        if (pictured_ && !plotly_js_) {
            put("<p class=\"note\">plotly.js was not found when this page was made, so the figures are "
                "pictures: no zoom, no "
                "values under the pointer.</p>\n");
        }
        const auto leads = [](const PageSection& one) { return one.leads; };
        const bool led = std::any_of(page.sections.begin(), page.sections.end(), leads);
        if (!led) {
            summary(page);
            contents(page);
        }
        for (const PageSection& one : page.sections) {
            if (one.leads)
                lead(one, one.title != page.title);
            else
                section(one);
            if (led && &one == page.sections.data()) contents(page);
        }
        put("<p class=\"note\">Made by {} {}; this page loads nothing from anywhere.</p>\n", tool_name,
            version());
        if (plotly_js_) put("<script>{}</script>\n<script>{}</script>\n", *plotly_js_, page_script);
        if (copies(page)) put("<script>{}</script>\n", copy_script);
        put("</body>\n</html>\n");
        return std::move(text_);
    }

  private:
    template <class... Args>
    void put(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    }
    static std::string shown(std::string_view text) { return html_escaped(visible_text(text)); }

    static bool copies(const Page& page) {
        return std::any_of(page.sections.begin(), page.sections.end(),
                           [](const PageSection& one) { return !one.commands.empty(); });
    }

    void head(const Page& page) {
        std::string scripts;
        if (plotly_js_) scripts = script_hash(*plotly_js_) + " " + script_hash(page_script);
        if (copies(page)) scripts += (scripts.empty() ? "" : " ") + script_hash(copy_script);
        if (scripts.empty()) scripts = "'none'";
        put("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
            "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src {}; "
            "style-src "
            "'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'\">\n"
            "<meta name=\"color-scheme\" content=\"light dark\">\n"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n"
            "<style>{}</style>\n</head>\n<body>\n",
            scripts, shown(page.title), page_style);
    }

    // The question, the verdict and the numbers of each result, before anything else.
    void summary(const Page& page) {
        put("<div class=\"summary\">\n");
        for (std::size_t i = 0; i < page.sections.size(); ++i) {
            const PageSection& one = page.sections[i];
            if (!one.in_summary) continue;
            put("<article class=\"result{}\">\n<h2><a href=\"#result-{}\">{}</a></h2>\n",
                badge(one.state).style, i + 1, shown(one.title));
            if (!one.verdict.empty()) put("<p>{}{}</p>\n", badge(one.state).words, shown(one.verdict));
            facts(one.key);
            put("</article>\n");
        }
        put("</div>\n");
    }

    // By PageState: the class of an answer, and what stands before it.
    struct Badge {
        std::string_view style, words;
    };
    static const Badge& badge(PageState state) {
        static constexpr std::array<Badge, 4> all = {
            {{"", ""},
             {" good", "<span class=\"state\">decided</span> "},
             {" doubtful", "<span class=\"state\">not decided</span> "},
             {" bad", "<span class=\"state\">amplifies an order</span> "}}};
        return all[static_cast<std::size_t>(state)];
    }

    void contents(const Page& page) {
        if (page.sections.size() < 2) return;
        // What stands above needs no entry; of several answers, one each is enough.
        const auto leads = std::count_if(page.sections.begin(), page.sections.end(),
                                         [](const PageSection& one) { return one.leads; });
        put("<nav>\n<h2>Contents</h2>\n<ol>\n");
        for (std::size_t i = leads > 0 ? 1 : 0; i < page.sections.size(); ++i)
            if (leads < 2 || page.sections[i].leads)
                put("<li><a href=\"#result-{}\">{}</a></li>\n", i + 1, shown(page.sections[i].title));
        put("</ol>\n</nav>\n");
    }

    void facts(const std::vector<PageFact>& all) {
        if (all.empty()) return;
        put("<ul class=\"facts\">\n");
        for (const PageFact& fact : all)
            put("<li><b>{}</b><span>{}</span></li>\n", shown(fact.value), shown(fact.name));
        put("</ul>\n");
    }

    // The picture, the answer, its numbers, and what to do.
    void lead(const PageSection& one, bool titled) {
        put("<section class=\"lead\">\n<h2 id=\"result-{}\"{}>{}</h2>\n", ++sections_,
            titled ? "" : " hidden", shown(one.title));
        if (!one.about.empty()) put("<p class=\"note\">{}</p>\n", shown(one.about));
        for (const Figure& drawn : one.figures) figure(drawn, false);
        if (!one.verdict.empty())
            put("<p class=\"verdict answer{}\">{}{}</p>\n", badge(one.state).style, badge(one.state).words,
                shown(one.verdict));
        for (const PageTable& numbers : one.tables) rows(numbers);
        for (const std::string& command : one.commands)
            put("<div class=\"command\"><pre>{}</pre><button type=\"button\">copy</button></div>\n",
                shown(command));
        put("</section>\n");
    }

    void section(const PageSection& one) {
        put("<section>\n<h2 id=\"result-{}\">{}</h2>\n", ++sections_, shown(one.title));
        if (!one.verdict.empty()) put("<p class=\"verdict\">{}</p>\n", shown(one.verdict));
        facts(one.key);
        if (!one.notes.empty()) {
            put("<ul>\n");
            for (const std::string& note : one.notes) put("<li>{}</li>\n", shown(note));
            put("</ul>\n");
        }
        for (const Figure& drawn : one.figures) figure(drawn, drawn.title != one.title);
        for (const PageTable& shown_table : one.tables)
            if (!shown_table.folded) table(shown_table);
        folded(one);
        put("</section>\n");
    }

    // Collapsed sections: ledgers, every value, how to make it again, the JSON.
    void folded(const PageSection& one) {
        for (const PageTable& ledger : one.tables) {
            if (!ledger.folded) continue;
            put("<details><summary>{} ({} row{})</summary>\n", shown(ledger.title), ledger.rows.size(),
                ledger.rows.size() == 1 ? "" : "s");
            rows(ledger);
            put("</details>\n");
        }
        if (!one.facts.empty()) {
            put("<details><summary>Every value</summary>\n");
            facts(one.facts);
            put("</details>\n");
        }
        reproduce(one);
    }

    // A panel of two dots, or of nothing, is none.
    static bool shows(const Panel& panel) {
        if (panel.map || !panel.ribbons.empty()) return true;
        std::size_t dots = 0;
        for (const Curve& curve : panel.curves) {
            const bool drawn = curve.style == CurveStyle::points || curve.style == CurveStyle::crosses;
            if (!drawn && curve.x.size() > 1) return true;
            dots += curve.x.size();
        }
        return dots > 2;
    }

    void figure(Figure drawn, bool titled) {
        std::erase_if(drawn.panels, [](const Panel& panel) { return !shows(panel); });
        if (drawn.panels.empty()) return;
        const std::string id = fmt::format("figure-{}", ++figures_);
        put("<figure>\n");
        if (titled) put("<h3>{}</h3>\n", shown(drawn.title));
        if (!drawn.sentence.empty()) put("<figcaption>{}</figcaption>\n", shown(drawn.sentence));
        if (plotly_js_) {
            put("<div class=\"plot\" id=\"{0}\"></div>\n<script type=\"application/json\" "
                "data-figure=\"{0}\">{1}</script>\n",
                id, plotly_text(drawn));
        } else if (const auto svg = draw_picture(drawn, PictureKind::svg)) {
            put("<img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\">\n", shown(drawn.title), base64(*svg));
        } else {
            put("<p class=\"note\">Neither plotly.js nor gnuplot was found to draw this figure; its numbers "
                "are in the result "
                "below.</p>\n");
        }
        put("</figure>\n");
    }

    void table(const PageTable& one) {
        put("<h3>{}</h3>\n", shown(one.title));
        rows(one);
    }

    void rows(const PageTable& one) {
        put("<div class=\"scroll\"><table>\n<thead><tr>");
        for (std::size_t c = 0; c < one.header.size(); ++c) {
            const bool words = !one.rows.empty() && !is_number(one.rows.front()[c]);
            put("<th{}>{}</th>", words ? " class=\"words\"" : "", shown(one.header[c]));
        }
        put("</tr></thead>\n<tbody>\n");
        for (const std::vector<std::string>& row : one.rows) {
            put("<tr>");
            for (const std::string& cell : row)
                put("<td{}>{}</td>", is_number(cell) ? "" : " class=\"words\"", shown(cell));
            put("</tr>\n");
        }
        put("</tbody>\n</table></div>\n");
        if (one.legend.empty()) return;
        put("<dl>\n");
        for (const PageFact& label : one.legend)
            put("<dt>{}</dt><dd>{}</dd>\n", shown(label.name), shown(label.value));
        put("</dl>\n");
    }

    void reproduce(const PageSection& one) {
        if (!one.command.empty() || !one.inputs.empty()) {
            put("<details><summary>Made by</summary>\n");
            if (!one.command.empty()) put("<pre>{}</pre>\n", shown(one.command));
            PageTable inputs{"From", {"file", "SHA-256"}, {}};
            for (const PageFact& input : one.inputs) inputs.rows.push_back({input.name, input.value});
            if (!inputs.rows.empty()) table(inputs);
            put("</details>\n");
        }
        // Shown as text and kept as data: a program finds it by its type.
        if (one.json.empty()) return;
        put("<details><summary>The result as JSON</summary><pre>{}</pre></details>\n",
            html_escaped(visible_json(one.json)));
    }

    bool pictured_ = false;
    std::optional<std::string> plotly_js_;  ///< where there is a figure to draw
    std::string text_;
    int figures_ = 0, sections_ = 0;
};

}  // namespace

std::string html_escaped(std::string_view text) {
    constexpr std::string_view special = "&<>\"'";
    constexpr std::array<std::string_view, 5> entities = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
    std::string escaped;
    escaped.reserve(text.size());
    for (const char c : text) {
        const std::size_t found = special.find(c);
        if (found == std::string_view::npos)
            escaped += c;
        else
            escaped += entities[found];
    }
    return escaped;
}

std::string html_page(const Page& page, const std::optional<std::string>& plotly_js) {
    return Writer(page, plotly_js).written(page);
}

}  // namespace ripplenotch
