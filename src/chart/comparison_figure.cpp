// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/chart/comparison_figure.hpp"
#include "ripplenotch/chart/table_figure.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {

namespace {

// "oscillator, error 0.0281 Nm rms"
std::string name_with_error(const MethodFigures& figures, const Comparison& comparison) {
    const std::string name =
        part_of(figures) == MethodPart::control ? "raw" : short_name(figures, comparison);
    if (!figures.error_rms_nm) return name;
    return fmt::format("{}, error {:.3g} Nm rms", name, *figures.error_rms_nm);
}

}  // namespace

void ComparedCourse::add(std::size_t method, const TraceView& block, std::span<const double> out_nm,
                         std::span<const double> truth_nm) {
    if (methods_.size() <= method) methods_.resize(method + 1);
    Course& course = methods_[method];
    for (std::size_t k = 0; k < std::min(out_nm.size(), truth_nm.size()); ++k) {
        if (block.starts_run(k)) {
            course.torque.break_here();
            course.error.break_here();
            if (method == 0) truth_.break_here();
        }
        course.torque.add(block.time_s[k], out_nm[k]);
        course.error.add(block.time_s[k], out_nm[k] - truth_nm[k]);
        if (method == 0) truth_.add(block.time_s[k], truth_nm[k]);
    }
}

Figure ComparedCourse::figure(const std::string& source, const Comparison& comparison) const {
    Panel torque{.title = "Torque", .x = {"time", "s"}, .y = {"torque", "Nm"}};
    Panel error{.title = "What each is off the true torque", .x = {"time", "s"}, .y = {"error", "Nm"}};
    error.legend = false;
    std::size_t taken = 0;
    for (std::size_t i = 0; i < std::min(methods_.size(), comparison.methods.size()); ++i) {
        const MethodFigures& figures = comparison.methods[i];
        const Ink ink = part_of(figures) == MethodPart::control ? Ink::grey : series_ink(taken++);
        const std::string name = name_with_error(figures, comparison);
        torque.curves.push_back(methods_[i].torque.curve(name, ink));
        error.curves.push_back(methods_[i].error.curve(name, ink));
    }
    torque.curves.push_back(truth_.curve("true torque", Ink::black));
    torque.curves.back().style = CurveStyle::dashed;
    return {"compared-log",
            fmt::format("Methods on one log: {}", source),
            differences(comparison),
            {std::move(torque), std::move(error)}};
}

namespace {

struct Look {
    Ink ink;
    CurveStyle style;
};

// The control is grey and dashed, methods take the inks in turn.
Look look_of(const Contender& contender, std::size_t& taken) {
    if (contender.method->part == MethodPart::control) return {Ink::grey, CurveStyle::dashed};
    const std::size_t i = taken++;
    return {series_ink(i), series_style(i, CurveStyle::line)};
}

// Short, as in the table; a contender that was not measured by its text.
std::string contender_name(const Comparison& comparison, const Contender& contender) {
    for (const MethodFigures& figures : comparison.methods) {
        if (figures.method == contender.text) return short_name(figures, comparison);
    }
    return contender.text;
}

// Half of the longest settling time before the signal and one and a half after it, within reason.
double shown_s(const Comparison& comparison) {
    double longest_ms = 0.0;
    for (const MethodFigures& figures : comparison.methods)
        if (figures.settle_ms) longest_ms = std::max(longest_ms, figures.settle_ms->front());
    return std::clamp(1.3e-3 * longest_ms, 40.0 / comparison.sample_rate.value(), 10.0);
}

// Output of a filter in steady state at torque 0, then `signal(t)` from t = 0 on.
template <class Signal>
Curve run(const Contender& contender, const std::string& name, const Comparison& comparison,
          double duration_s, const Look& look, const Signal& signal) {
    const double rate = comparison.sample_rate.value();
    const auto before = static_cast<std::size_t>(0.1 * duration_s * rate) + 1;
    const auto count = before + static_cast<std::size_t>(duration_s * rate) + 1;
    std::vector<double> torque(count), position(count), out(count);
    const std::vector<double> velocity(count, comparison.speed.value());
    MinMaxCourse course;
    for (std::size_t k = 0; k < count; ++k) {
        const double t = (static_cast<double>(k) - static_cast<double>(before)) / rate;
        torque[k] = k < before ? 0.0 : signal(t);
        position[k] = comparison.speed.value() * t;
    }
    const auto filter = contender.start_on_bench(comparison.sample_rate);
    filter->process({velocity, torque, position}, out);
    for (std::size_t k = 0; k < count; ++k)
        course.add(1e3 * (static_cast<double>(k) - static_cast<double>(before)) / rate, out[k]);
    Curve curve = course.curve(name, look.ink);
    curve.style = look.style;
    return curve;
}

std::vector<Panel> course_panels(const Comparison& comparison, std::span<const Contender> contenders) {
    std::vector<Panel> panels;
    const double duration_s = shown_s(comparison);
    const PlotAxis time{"time", "ms"};
    Panel step{.title = "", .x = time, .y = {"torque", "Nm"}}, ramp = step;
    step.legend = ramp.legend = false;
    std::size_t taken = 0;
    for (const Contender& contender : contenders) {
        const Look look = look_of(contender, taken);
        if (comparison.step_nm) {
            const double height = *comparison.step_nm;
            step.curves.push_back(run(contender, contender_name(comparison, contender), comparison,
                                      duration_s, look, [height](double) { return height; }));
        }
        if (comparison.ramp_nm_s) {
            const double slope = *comparison.ramp_nm_s;
            ramp.curves.push_back(run(contender, contender_name(comparison, contender), comparison,
                                      duration_s, look, [slope](double t) { return slope * t; }));
        }
    }
    if (comparison.step_nm) {
        step.title = fmt::format("A step of {:.4g} Nm", *comparison.step_nm);
        panels.push_back(std::move(step));
    }
    if (comparison.ramp_nm_s) {
        ramp.title = fmt::format("A ramp of {:.4g} Nm/s", *comparison.ramp_nm_s);
        panels.push_back(std::move(ramp));
    }
    return panels;
}

struct ResponsePanels {
    Panel magnitude, phase, delay;
};

ResponsePanels empty_panels(const Comparison& comparison) {
    const PlotAxis frequency{"frequency", "Hz", PlotScale::logarithmic};
    ResponsePanels panels{{.title = "Magnitude", .x = frequency, .y = {"gain", "dB"}},
                          {.title = "Phase", .x = frequency, .y = {"phase", "deg"}},
                          {.title = "Group delay", .x = frequency, .y = {"delay", "ms"}}};
    panels.phase.legend = panels.delay.legend = false;
    if (!comparison.lines) return panels;
    for (const Order order : comparison.lines->orders) {
        const double hz = ripple_frequency(order, comparison.lines->ratio, comparison.speed).value();
        panels.magnitude.lines.push_back(
            {order_in_words(order, comparison.lines->ratio), NamedLine::Run::at_x, hz, Ink::black});
    }
    return panels;
}

// Near a null the delay of a notch is so large that the rest of the picture would be a line: the axis is
// limited to the delays at low frequencies.
void fit_delay_axis(Panel& delay, double longest_dc_ms) {
    delay.y.from = -0.25 * std::max(longest_dc_ms, 1.0);
    delay.y.to = 1.25 * std::max(longest_dc_ms, 1.0);
}

std::vector<Panel> response_panels(const Comparison& comparison, std::span<const Contender> contenders) {
    ResponsePanels panels = empty_panels(comparison);
    std::vector<double> lines_hz;
    for (const NamedLine& line : panels.magnitude.lines) lines_hz.push_back(line.value);
    std::size_t taken = 0;
    double longest_dc_ms = 0.0, deepest_db = -20.0;
    for (const Contender& contender : contenders) {
        const Look look = look_of(contender, taken);
        const auto frozen = contender.frozen(comparison.sample_rate, comparison.speed);
        if (!frozen) continue;
        const FilterResponse response = filter_response(frozen->cascade, comparison.sample_rate, lines_hz);
        panels.magnitude.curves.push_back({contender_name(comparison, contender), look.ink, look.style,
                                           response.hz, response.magnitude_db});
        panels.phase.curves.push_back(
            {contender_name(comparison, contender), look.ink, look.style, response.hz, response.phase_deg});
        panels.delay.curves.push_back({contender_name(comparison, contender), look.ink, look.style,
                                       response.hz, response.group_delay_ms});
        longest_dc_ms = std::max(longest_dc_ms, response.group_delay_ms.front());
        deepest_db = std::min(deepest_db,
                              *std::min_element(response.magnitude_db.begin(), response.magnitude_db.end()));
    }
    if (panels.magnitude.curves.empty()) return {};
    panels.magnitude.y.from = std::max(deepest_db - 5.0, -85.0);
    panels.magnitude.y.to = 8.0;
    fit_delay_axis(panels.delay, longest_dc_ms);
    return {std::move(panels.magnitude), std::move(panels.phase), std::move(panels.delay)};
}

}  // namespace

Figure comparison_figure(const Comparison& comparison, std::span<const Contender> contenders) {
    Figure figure{"comparison",
                  fmt::format("Methods at {:.6g} deg/s, sampled at {:.6g} Hz", comparison.speed.value(),
                              comparison.sample_rate.value()),
                  differences(comparison),
                  {}};
    std::vector<Panel> responses = response_panels(comparison, contenders);
    std::vector<Panel> courses = course_panels(comparison, contenders);
    if (responses.empty() && !courses.empty()) courses.front().legend = true;
    // Frequency at the left, time at the right.
    figure.columns = responses.empty() || courses.empty() ? 1 : 2;
    for (std::size_t i = 0; i < std::max(responses.size(), courses.size()); ++i) {
        if (i < responses.size()) figure.panels.push_back(std::move(responses[i]));
        if (i < courses.size()) figure.panels.push_back(std::move(courses[i]));
    }
    return figure;
}

}  // namespace ripplenotch
