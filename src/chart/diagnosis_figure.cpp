// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t map_columns = 60, map_rows = 30;

std::vector<double> edges_over(std::span<const double> values, std::size_t count) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    // A value that never changes still has a cell to be in.
    const double from = *low, to = *high > *low ? *high : *low + std::max(1.0, 0.01 * std::abs(*low));
    std::vector<double> edges(count + 1);
    for (std::size_t i = 0; i <= count; ++i)
        edges[i] = from + (to - from) * static_cast<double>(i) / static_cast<double>(count);
    return edges;
}

std::size_t cell_of(const std::vector<double>& edges, double value) {
    const double share = (value - edges.front()) / (edges.back() - edges.front());
    const auto cells = static_cast<double>(edges.size() - 1);
    return static_cast<std::size_t>(std::clamp(std::floor(share * cells), 0.0, cells - 1.0));
}

HeatMap rms_map(std::span<const double> across, std::span<const double> along,
                std::span<const double> residual_nm) {
    HeatMap map{.label = "rms residual", .unit = "Nm"};
    map.x_edges = edges_over(across, map_columns);
    map.y_edges = edges_over(along, map_rows);
    std::vector<double> sum(map_columns * map_rows, 0.0), count(sum);
    for (std::size_t k = 0; k < residual_nm.size(); ++k) {
        const std::size_t cell =
            cell_of(map.y_edges, along[k]) * map_columns + cell_of(map.x_edges, across[k]);
        sum[cell] += residual_nm[k] * residual_nm[k];
        count[cell] += 1.0;
    }
    for (std::size_t i = 0; i < sum.size(); ++i)
        map.cells.push_back(count[i] > 0.0 ? std::sqrt(sum[i] / count[i]) : not_a_number);
    return map;
}

double highest_cell(const HeatMap& map) {
    double highest = 0.0;
    for (const double cell : map.cells)
        if (cell > highest) highest = cell;
    return highest > 0.0 ? highest : 1.0;
}

Curve course_of(std::string name, Ink ink, std::span<const double> x, std::span<const double> y) {
    MinMaxCourse course;
    for (std::size_t k = 0; k < x.size(); ++k) course.add(x[k], y[k]);
    return course.curve(std::move(name), ink);
}

}  // namespace

Figure residual_figure(const std::string& title, const std::string& sentence, const Residuals& residuals,
                       std::optional<double> noise_floor_nm) {
    const bool two = !residuals.after_nm.empty();
    Figure figure{"residual", title, sentence, {}};
    Panel course{.title = "Measured less modelled torque", .x = {"time", "s"}, .y = {"torque", "Nm"}};
    course.curves.push_back(
        course_of(two ? "before" : "residual", Ink::orange, residuals.time_s, residuals.before_nm));
    if (two) course.curves.push_back(course_of("after", Ink::blue, residuals.time_s, residuals.after_nm));
    figure.panels.push_back(std::move(course));

    const bool positioned = !residuals.position_deg.empty();
    const auto across = positioned ? residuals.position_deg : residuals.time_s;
    const PlotAxis x = positioned ? PlotAxis{"position", "deg"} : PlotAxis{"time", "s"};
    double highest = 0.0;
    for (const auto& [residual_nm, name] :
         {std::pair{residuals.before_nm, "before"}, {residuals.after_nm, "after"}}) {
        if (residual_nm.empty()) continue;
        Panel panel{.title = two ? fmt::format("Where they disagree, {}", name) : "Where they disagree",
                    .x = x,
                    .y = {"joint speed", "deg/s"}};
        HeatMap map = rms_map(across, residuals.speed_deg_s, residual_nm);
        // The colour range of the first holds for the second, so that a smaller residual looks smaller.
        if (highest == 0.0) highest = highest_cell(map);
        map.lowest = std::min(noise_floor_nm.value_or(0.0), 0.5 * highest);
        map.highest = highest;
        panel.map = std::move(map);
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

namespace {

// "coulomb-friction", "ripple (ambiguous)"
std::string round_name(const Finding& finding) {
    if (finding.status == FindingStatus::confirmed) return std::string(finding.term.effect->name);
    return fmt::format("{} ({})", finding.term.effect->name, status_name(finding.status));
}

}  // namespace

Figure gap_figure(const std::string& title, const Diagnosis& diagnosis) {
    std::vector<Finding> rounds;
    std::ranges::copy_if(diagnosis.rounds, std::back_inserter(rounds), &Finding::is_in_model);
    Panel panel{.title = "", .x = {"round", "", PlotScale::whole}, .y = {"rms residual", "Nm"}};
    panel.x.from = -0.5;
    panel.x.to = static_cast<double>(rounds.size()) + 0.5;
    panel.y.from = 0.0;
    Curve gap{"gap", Ink::blue, CurveStyle::line, {}, {}};
    gap.x.push_back(0.0);
    gap.y.push_back(rounds.empty() ? diagnosis.gap.before_nm : rounds.front().gap_before_nm);
    for (std::size_t i = 0; i < rounds.size(); ++i) {
        gap.x.push_back(static_cast<double>(i + 1));
        gap.y.push_back(rounds[i].gap_after_nm);
        panel.lines.push_back({fmt::format("{}: {}", i + 1, round_name(rounds[i])), NamedLine::Run::at_x,
                               static_cast<double>(i + 1), Ink::grey});
    }
    Curve points = gap;
    points.name.clear();
    points.style = CurveStyle::points;
    panel.curves = {std::move(gap), std::move(points)};
    panel.lines.push_back({"noise floor", NamedLine::Run::at_y, diagnosis.gap.noise_floor_nm, Ink::black});
    return {"gap", title, "", {std::move(panel)}};
}

Figure diagnosis_figure(const std::string& source, const Diagnosis& diagnosis, const TraceView& log) {
    const std::vector<double>& before = diagnosis.residual_before_nm;
    std::vector<double> after;  // none where nothing was added: the same picture twice
    if (!diagnosis.rounds.empty()) after = diagnosis.residual_after_nm;
    Figure figure = residual_figure(fmt::format("Model and log: {}", source), diagnosis_sentence(diagnosis),
                                    {log.time_s, log.velocity_deg_s, log.position_deg, before, after},
                                    diagnosis.gap.noise_floor_nm);
    figure.name = "diagnosis";
    Panel gap = std::move(gap_figure("", diagnosis).panels.front());
    gap.title = "The gap, round by round";
    figure.panels.insert(figure.panels.begin(), std::move(gap));
    return figure;
}

}  // namespace ripplenotch
