// SPDX-License-Identifier: MIT
#include "ripplenotch/page/plotly.hpp"

#include <algorithm>

#include "figure/gnuplot_script.hpp"
#include "figure/picture_layout.hpp"
#include "page/plotly_lines.hpp"
#include "page/plotly_traces.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr double left_margin_px = 84.0, tool_bar_px = 34.0;
constexpr double axis_px = 56.0, row_px = 24.0;

constexpr double phone_px = 280.0;  // a panel's width on a screen of 400

// Rows that the names of a panel's curves fill, set one after the other as far as there is room.
std::size_t legend_rows(const Panel& panel, double room_px) {
    if (!panel.legend) return 0;
    std::size_t rows = 0;
    double used_px = room_px + 1.0;
    for (const std::string& name : legend_names(panel)) {
        const double px = letter_px * static_cast<double>(text_width(name)) + 60.0;
        if (used_px + px > room_px) {
            ++rows;
            used_px = 0.0;
        }
        used_px += px;
    }
    return rows;
}

// One panel of the figure; axes are numbered from 1, and 1 is written without its number.
class PlotlyPanel {
  public:
    PlotlyPanel(const Panel& panel, std::size_t number, double room_px, Json& data, Json& layout)
        : panel_(panel),
          room_px_(room_px),
          suffix_(number == 1 ? "" : std::to_string(number)),
          x_(x_range(panel)),
          y_(y_range(panel)),
          lines_(panel, suffix_),
          data_(data),
          layout_(layout) {}

    void write(double bottom, double top, double total_px, const std::string& linked_to) {
        axis("xaxis", panel_.x, x_);
        axis("yaxis", panel_.y, y_);
        Json& x = layout_["xaxis" + suffix_];
        Json& y = layout_["yaxis" + suffix_];
        x["anchor"] = "y" + suffix_;
        y["anchor"] = "x" + suffix_;
        y["domain"] = {bottom, top};
        if (!linked_to.empty()) x["matches"] = linked_to;
        if (panel_.map) {
            x["showgrid"] = y["showgrid"] = false;
            data_.push_back(map_trace(trace("heatmap", panel_.map->label), panel_, bottom, top));
        }
        for (const Shade& shade : panel_.shades) draw(shade);
        for (const Ribbon& ribbon : panel_.ribbons) {
            for (const bool upper : {false, true})
                data_.push_back(ribbon_trace(trace("scatter", ribbon.name), ribbon, upper));
        }
        for (const Curve& curve : panel_.curves)
            data_.push_back(curve_trace(trace("scatter", curve.name), panel_, curve));
        lines_.write(layout_);
        if (!panel_.title.empty()) {
            layout_["annotations"].push_back({{"text", title_text()},
                                              {"xref", "paper"},
                                              {"yref", "paper"},
                                              {"x", 0},
                                              {"xshift", 12.0 - left_margin_px},
                                              {"align", "left"},
                                              {"y", top + (lines_.names_px(true) + 6.0) / total_px},
                                              {"xanchor", "left"},
                                              {"yanchor", "bottom"},
                                              {"showarrow", false},
                                              {"font", {{"size", 13}, {"color", "#222"}}}});
        }
        layout_["legend" + suffix_] = {{"orientation", "h"}, {"x", 0},
                                       {"xanchor", "left"},  {"y", bottom - axis_px / total_px},
                                       {"yanchor", "top"},   {"font", {{"size", 12}}}};
    }

    /// Space for the names of lines above the panel, or right of it.
    [[nodiscard]] double names_px(bool on_top) const { return lines_.names_px(on_top); }
    [[nodiscard]] double height_px() const {
        const auto rows = static_cast<double>(legend_rows(panel_, room_px_));
        return lines_.names_px(true) + panel_px * panel_.height + axis_px + row_px * rows + 46.0;
    }
    [[nodiscard]] double above_px() const {
        return lines_.names_px(true) + 12.0 + 18.0 * static_cast<double>(title_lines().size());
    }

  private:
    // Narrow enough for a phone.
    [[nodiscard]] std::vector<std::string> title_lines() const {
        return wrapped(visible_text(panel_.title), 44);
    }
    [[nodiscard]] std::string title_text() const { return joined(title_lines()); }
    // No longer than the axis that it stands beside.
    [[nodiscard]] std::string axis_title(std::string_view which, const PlotAxis& axis) const {
        const double room_px = which == "yaxis" ? panel_px * panel_.height : 0.5 * plot_px;
        return joined(wrapped(visible_text(axis_text(axis)), static_cast<std::size_t>(room_px / letter_px)));
    }
    static std::string joined(const std::vector<std::string>& lines) {
        std::string text;
        for (const std::string& line : lines) text += (text.empty() ? "" : "<br>") + plotly_shown(line);
        return text;
    }
    void axis(const char* which, const PlotAxis& axis, const PlotRange& range) {
        const bool log = axis.scale == PlotScale::logarithmic;
        Json& json = layout_[which + suffix_];
        json = {
            {"title", {{"text", axis_title(which, axis)}, {"font", {{"size", 13}}}, {"standoff", 8}}},
            {"type", log ? "log" : "linear"},
            {"range",
             {log ? portable::log10(range.from) : range.from, log ? portable::log10(range.to) : range.to}},
            {"gridcolor", "#e3e3e3"},
            {"linecolor", "#555"},
            {"showline", true},
            {"zeroline", false},
            {"ticks", "outside"}};
        if (!log) json["tickformat"] = ".6~g";
        if (axis.scale == PlotScale::whole) json["dtick"] = whole_step(range);
    }

    Json trace(const std::string& type, const std::string& name) const {
        Json json{{"type", type},
                  {"xaxis", "x" + suffix_},
                  {"yaxis", "y" + suffix_},
                  {"name", plotly_shown(name)},
                  {"legend", "legend" + suffix_},
                  {"legendgroup", plotly_shown(name)}};
        json["showlegend"] = panel_.legend && !name.empty() && type == "scatter";
        return json;
    }

    void draw(const Shade& shade) {
        const bool whole = !std::isfinite(shade.y_from) && !std::isfinite(shade.y_to);
        const auto within = [](double value, const PlotRange& range) {
            return std::isnan(value) ? range.from : std::clamp(value, range.from, range.to);
        };
        const double x0 = within(shade.x_from, x_), x1 = within(shade.x_to, x_);
        layout_["shapes"].push_back({{"type", "rect"},
                                     {"layer", "below"},
                                     {"xref", "x" + suffix_},
                                     {"yref", "y" + suffix_ + (whole ? " domain" : "")},
                                     {"x0", plotly_number(x0)},
                                     {"x1", plotly_number(x1)},
                                     {"y0", whole ? Json(0) : plotly_number(within(shade.y_from, y_))},
                                     {"y1", whole ? Json(1) : plotly_number(within(shade.y_to, y_))},
                                     {"fillcolor", ink_rgb(shade.ink) + "24"},
                                     {"line", {{"width", 0}}}});
        const double room_px = (x1 - x0) / (x_.to - x_.from) * 0.5 * plot_px;  // half: phones are narrow
        if (shade.name.empty() || small_letter_px * static_cast<double>(text_width(shade.name)) > room_px)
            return;
        layout_["annotations"].push_back({{"text", plotly_shown(shade.name)},
                                          {"xref", "x" + suffix_},
                                          {"yref", "y" + suffix_ + " domain"},
                                          {"x", plotly_number(0.5 * (x0 + x1))},
                                          {"y", 1},
                                          {"yanchor", "top"},
                                          {"showarrow", false},
                                          {"font", {{"size", 11}, {"color", "#444"}}}});
    }

    const Panel& panel_;
    double room_px_;
    std::string suffix_;
    PlotRange x_, y_;
    PlotlyLines lines_;
    Json& data_;
    Json& layout_;
};

bool alike(const Panel& a, const Panel& b) {
    const PlotRange x = x_range(a), y = x_range(b);
    const auto near = [](double p, double q, double span) { return std::abs(p - q) <= 1e-9 * span; };
    return a.x.label == b.x.label && a.x.unit == b.x.unit && a.x.scale == b.x.scale &&
           near(x.from, y.from, x.to - x.from) && near(x.to, y.to, x.to - x.from);
}

// The figure where a panel is so wide.
Json drawn(const Figure& figure, double room_px) {
    Json data = Json::array();
    Json layout{{"shapes", Json::array()}, {"annotations", Json::array()}};
    double total_px = 0.0, beside_px = 24.0;
    std::vector<PlotlyPanel> panels;
    panels.reserve(figure.panels.size());
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
        panels.emplace_back(figure.panels[i], i + 1, room_px, data, layout);
        total_px += panels.back().height_px() + panels.back().above_px() - panels.back().names_px(true);
        beside_px =
            std::max(beside_px, panels.back().names_px(false) + 10.0 + (figure.panels[i].map ? 90.0 : 0.0));
    }
    double at_px = total_px;
    for (std::size_t i = 0; i < panels.size(); ++i) {
        at_px -= panels[i].above_px();
        const double top = at_px / total_px, bottom = (at_px - panel_px * figure.panels[i].height) / total_px;
        std::string linked;
        for (std::size_t k = 0; k < i && linked.empty(); ++k)
            if (alike(figure.panels[k], figure.panels[i]))
                linked = k == 0 ? "x" : "x" + std::to_string(k + 1);
        panels[i].write(bottom, top, total_px, linked);
        at_px -= panels[i].height_px() - panels[i].names_px(true);
    }
    layout["height"] = total_px + tool_bar_px + 10.0;
    layout["margin"] = {{"l", left_margin_px}, {"r", beside_px}, {"t", tool_bar_px}, {"b", 10}};
    layout["font"] = {{"family", "system-ui, sans-serif"}, {"size", 12}, {"color", "#1b1b1b"}};
    layout["plot_bgcolor"] =
        std::any_of(figure.panels.begin(), figure.panels.end(), [](const Panel& p) { return p.map; })
            ? "#eeeeee"
            : "#ffffff";
    layout["hovermode"] = "closest";
    layout["dragmode"] = "zoom";
    return Json{{"data", std::move(data)}, {"layout", std::move(layout)}};
}

// What is different where a screen is narrow, so that names of curves take more rows: paths and their values.
Json narrow_changes(const Figure& figure, const Json& wide) {
    Json changes = Json::array();
    const bool same = std::all_of(figure.panels.begin(), figure.panels.end(), [](const Panel& panel) {
        return legend_rows(panel, phone_px) == legend_rows(panel, plot_px);
    });
    if (same) return changes;
    const Json narrow = drawn(figure, phone_px);
    const auto add = [&](const Json& from, const Json& to, const std::string& place) {
        for (const Json& one : Json::diff(from, to))
            changes.push_back({{"path", place + one["path"].get<std::string>()}, {"value", one["value"]}});
    };
    add(wide["layout"], narrow["layout"], "/layout");
    for (std::size_t i = 0; i < wide["data"].size(); ++i) {
        const Json &trace = wide["data"][i], &other = narrow["data"][i];
        if (trace.contains("colorbar"))
            add(trace["colorbar"], other["colorbar"], "/data/" + std::to_string(i) + "/colorbar");
    }
    return changes;
}

}  // namespace

std::string plotly_text(const Figure& figure) {
    check_figure(figure);
    Json json = drawn(figure, plot_px);
    if (Json changes = narrow_changes(figure, json); !changes.empty()) json["narrow"] = std::move(changes);
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    // "<br>" and "<extra>" of templates included: JSON reads it back the same.
    for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
        text.replace(at, 1, "\\u003c");
    return text;
}

}  // namespace ripplenotch
