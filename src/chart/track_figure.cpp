// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/matrices/least_squares.hpp"
#include "ripplenotch/analysis/track_report.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {

namespace {

constexpr int steps = 40;

/// Amplitude and error at one speed, the second comb averaged out.
struct At {
    std::complex<double> value;
    double error_nm = 0.0;
};

At at_speed(const MapFit& fit, std::size_t order, double speed_deg_s) {
    const MapForm& form = fit.map.form;
    std::vector<double> weights(form.columns());
    map_weights(fit.map, {speed_deg_s, fit.map.zero_deg}, weights);
    At found;
    double square = 0.0;
    for (std::size_t c = 0; c < weights.size(); ++c) {
        if (form.is_second_comb(c)) continue;
        found.value += weights[c] * fit.map.values[order][c];
        square += weights[c] * weights[c] * 0.5 * std::norm(fit.errors[order][c]);
    }
    found.error_nm = std::sqrt(square);
    return found;
}

void add_curves(const MapFit& fit, std::size_t order, double sign, const std::string& name, Panel& amplitude,
                Panel& phase) {
    const double ordinal = fit.map.orders[order].value();
    // Backward has the colour of its order and the other mark.
    const Ink ink = order_ink(ordinal);
    const auto style = [&](CurveStyle one) {
        return sign < 0.0 ? other_mark(one) : order_style(ordinal, one);
    };
    Curve size{name, ink, style(CurveStyle::line), {}, {}},
        angle{name, ink, style(CurveStyle::points), {}, {}};
    Ribbon ribbon{"", ink, {}, {}, {}}, doubt{"", ink, {}, {}, {}};
    const MapRange& range = fit.map.speeds_deg_s;
    for (int k = 0; k <= steps; ++k) {
        const double speed = range.from + (range.to - range.from) * k / steps;
        const At at = at_speed(fit, order, sign * speed);
        const double nm = portable::hypot(at.value.real(), at.value.imag());
        size.x.push_back(speed);
        size.y.push_back(nm);
        angle.x.push_back(speed);
        // A phase goes on where it ended: at half a turn it does not jump to the other edge.
        double deg = -portable::arg(at.value) * degrees_per_radian;
        if (k > 0) deg += 360.0 * std::round((angle.y.back() - deg) / 360.0);
        angle.y.push_back(deg);
        // An amplitude that may be 0 may have any phase.
        const double off = normal_95_errors * at.error_nm;
        const double off_deg = off < nm ? portable::atan2(off, nm) * degrees_per_radian : 180.0;
        doubt.x.push_back(speed);
        doubt.low.push_back(deg - off_deg);
        doubt.high.push_back(deg + off_deg);
        ribbon.x.push_back(speed);
        ribbon.low.push_back(std::max(0.0, nm - normal_95_errors * at.error_nm));
        ribbon.high.push_back(nm + normal_95_errors * at.error_nm);
    }
    amplitude.ribbons.push_back(std::move(ribbon));
    amplitude.curves.push_back(std::move(size));
    phase.ribbons.push_back(std::move(doubt));
    phase.curves.push_back(std::move(angle));
}

}  // namespace

Figure map_figure(const std::string& source, const MapFit& fit) {
    const PlotAxis speed{"joint speed", "deg/s"};
    Panel amplitude{.title = "Amplitude", .x = speed, .y = {"amplitude, zero to peak", "Nm"}};
    Panel phase{.title = "Phase against the motor's angle",
                .x = speed,
                .y = {"phase", "deg"},
                .legend = false,
                .height = 0.7};
    amplitude.y.from = 0.0;
    for (std::size_t i = 0; i < fit.map.orders.size(); ++i) {
        const std::string order = order_in_words(fit.map.orders[i], fit.map.gear_ratio);
        const bool one_way = fit.map.form.directions == 1;
        add_curves(fit, i, 1.0, one_way ? order : order + " forward", amplitude, phase);
        if (!one_way) add_curves(fit, i, -1.0, order + " backward", amplitude, phase);
    }
    return {"ripple-map", fmt::format("Ripple over speed: {}", source), "", {amplitude, phase}};
}

namespace {

constexpr double stretch_s = 0.5;
constexpr std::size_t max_in_stretch = 4096, fewest_stretches = 3;

}  // namespace

void CloseUp::add(const CourseSample& sample) {
    const auto& [time_s, speed_deg_s, before_nm, after_nm] = sample;
    const bool full = now_.time_s.size() == max_in_stretch;
    if (!now_.time_s.empty() && (full || time_s - now_.time_s.front() >= stretch_s)) end_stretch();
    now_.time_s.push_back(time_s);
    now_.before_nm.push_back(before_nm);
    now_.after_nm.push_back(after_nm);
}

void CloseUp::end_stretch() {
    ++ended_;
    // By the median of its parts: a jump is in one of them, ripple in all.
    std::array<double, 5> parts{};
    for (std::size_t k = 1; k < now_.time_s.size(); ++k) {
        const double step =
            (now_.before_nm[k] - now_.after_nm[k]) - (now_.before_nm[k - 1] - now_.after_nm[k - 1]);
        if (std::isfinite(step)) parts[k * parts.size() / now_.time_s.size()] += step * step;
    }
    std::sort(parts.begin(), parts.end());
    now_.taken_off = parts[parts.size() / 2];
    if (now_.taken_off > best_.taken_off) best_ = now_;
    now_ = {};
}

std::optional<Panel> CloseUp::panel() const {
    if (ended_ < fewest_stretches || best_.time_s.empty()) return std::nullopt;
    Panel panel{.title = "Detail where the filter removes most", .x = {"time", "s"}, .y = {"torque", "Nm"}};
    panel.x.from = best_.time_s.front();
    panel.x.to = best_.time_s.back();
    panel.curves = {{"before", Ink::orange, CurveStyle::line, best_.time_s, best_.before_nm},
                    {"after", Ink::blue, CurveStyle::line, best_.time_s, best_.after_nm}};
    return panel;
}

void TorqueCourse::add(const CourseSample& sample) {
    const auto& [time_s, speed_deg_s, before_nm, after_nm] = sample;
    if (!any_) first_s_ = time_s;
    any_ = true;
    last_s_ = time_s;
    speed_.add(time_s, speed_deg_s);
    before_.add(time_s, before_nm);
    after_.add(time_s, after_nm);
    close_up_.add(sample);
}

Figure TorqueCourse::figure(const std::string& source, const std::string& method,
                            const StreamReport& report) const {
    PlotAxis time{"time", "s"};
    time.from = first_s_;
    time.to = last_s_;
    Figure figure{"torque", fmt::format("{}: {}", source, method), "", {}};
    if (std::optional<Panel> close_up = close_up_.panel()) figure.panels.push_back(std::move(*close_up));
    Panel torque{.title = "Torque before and after", .x = time, .y = {"torque", "Nm"}};
    torque.curves = {before_.curve("before", Ink::orange), after_.curve("after", Ink::blue)};
    Panel speed{.title = "Joint speed", .x = time, .y = {"speed", "deg/s"}, .height = 0.5};
    speed.curves = {speed_.curve("", Ink::black)};
    figure.panels.push_back(std::move(torque));
    figure.panels.push_back(std::move(speed));
    if (report.switches.empty()) return figure;

    Curve band{"",
               Ink::green,
               CurveStyle::steps,
               {first_s_},
               {static_cast<double>(report.switches[0].change.from_band)}};
    Curve jump{"", Ink::vermilion, CurveStyle::stems, {}, {}};
    for (const TimedSwitch& one : report.switches) {
        band.x.push_back(one.time_s);
        band.y.push_back(one.change.to_band);
        jump.x.push_back(one.time_s);
        jump.y.push_back(one.change.jump_nm);
    }
    band.x.push_back(last_s_);
    band.y.push_back(band.y.back());
    Panel in_force{.title = "Active band (0: none)", .x = time, .y = {"band", ""}, .height = 0.5};
    in_force.curves = {thinned(band)};
    Panel jumps{.title = "Jump of the output at each switch", .x = time, .y = {"jump", "Nm"}, .height = 0.5};
    jumps.curves = {thinned(jump)};
    figure.panels.push_back(std::move(in_force));
    figure.panels.push_back(std::move(jumps));
    figure.sentence =
        fmt::format("{}{}.", how_many(report.switch_count, "change of filter", "changes of filter"),
                    report.switches.size() < report.switch_count
                        ? fmt::format(", the first {} shown", report.switches.size())
                        : "");
    return figure;
}

namespace {

constexpr std::size_t max_ribbon_rows = 2000;

Ink track_ink(const TrackName& line) {
    if (line.order) return order_ink(*line.order);
    return line.is_tone ? tone_ink : unknown_ink;
}

CurveStyle track_style(const TrackName& line, CurveStyle style) {
    return line.order ? order_style(*line.order, style) : other_mark(style);
}

// A nan before each row that does not follow on the one before it.
void break_at(const std::vector<std::size_t>& breaks, Curve& curve) {
    for (std::size_t i = breaks.size(); i-- > 0;) {
        const auto at = static_cast<std::ptrdiff_t>(breaks[i]);
        curve.x.insert(curve.x.begin() + at, 0.5 * (curve.x[breaks[i] - 1] + curve.x[breaks[i]]));
        curve.y.insert(curve.y.begin() + at, not_a_number);
    }
}

// A ribbon has no holes: one for each stretch.
std::vector<Ribbon> parts_of(const Ribbon& whole, const std::vector<std::size_t>& breaks) {
    std::vector<Ribbon> parts;
    for (std::size_t i = 0; i <= breaks.size(); ++i) {
        const std::size_t from = i == 0 ? 0 : breaks[i - 1];
        const std::size_t to = i < breaks.size() ? breaks[i] : whole.x.size();
        const auto part = [from, to](const std::vector<double>& values) {
            return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(from),
                                       values.begin() + static_cast<std::ptrdiff_t>(to));
        };
        if (from < to)
            parts.push_back({whole.name, whole.ink, part(whole.x), part(whole.low), part(whole.high)});
    }
    return parts;
}

void add_line(Panel& amplitude, Panel& phase, const TrackName& line, const std::vector<double>& x,
              const std::vector<double>& amplitude_nm, const std::vector<double>& half_width_nm,
              const std::vector<double>& phase_deg, const std::vector<std::size_t>& breaks) {
    const Ink ink = track_ink(line);
    Ribbon ribbon{"", ink, x, {}, {}};
    for (std::size_t i = 0; i < x.size(); ++i) {
        ribbon.low.push_back(std::max(0.0, amplitude_nm[i] - half_width_nm[i]));
        ribbon.high.push_back(amplitude_nm[i] + half_width_nm[i]);
    }
    // A ribbon of more rows than a picture has columns would be a blur.
    if (x.size() <= max_ribbon_rows) {
        for (Ribbon& part : parts_of(ribbon, breaks)) amplitude.ribbons.push_back(std::move(part));
    }
    Curve curve{line.words, ink, track_style(line, CurveStyle::line), x, amplitude_nm};
    break_at(breaks, curve);
    amplitude.curves.push_back(thinned(curve));
    phase.curves.push_back(thinned({line.words, ink, track_style(line, CurveStyle::points), x, phase_deg}));
}

// `width_of` a line: half of its ribbon, row by row.
template <class Tracks, class WidthOf>
Figure figure_over(const std::string& source, const PlotAxis& x, const std::vector<double>& at,
                   const Tracks& tracks, std::span<const TrackName> names, const WidthOf& width_of) {
    Panel amplitude{.title = "Amplitude", .x = x, .y = {"amplitude, zero to peak", "Nm"}};
    Panel phase{.title = "Phase against the angle of the shaft",
                .x = x,
                .y = {"phase", "deg"},
                .legend = false,
                .height = 0.7};
    amplitude.y.from = 0.0;
    phase.y.from = -180.0;
    phase.y.to = 180.0;
    const std::vector<std::size_t> breaks = track_breaks(tracks);
    for (std::size_t i = 0; i < tracks.lines.size(); ++i)
        add_line(amplitude, phase, names[i], at, tracks.lines[i].amplitude_nm, width_of(tracks.lines[i]),
                 tracks.lines[i].phase_deg, breaks);
    return {"track",
            fmt::format("Lines of the torque along the log: {}", source),
            "",
            {std::move(amplitude), std::move(phase)}};
}

}  // namespace

Figure track_figure(const std::string& source, const OrderTracks& tracks, std::span<const TrackName> names) {
    return figure_over(source, {"time", "s"}, tracks.time_s, tracks, names, [](const auto& line) {
        std::vector<double> twice = line.standard_error_nm;
        for (double& error : twice) error *= 2.0;
        return twice;
    });
}

Figure track_figure(const std::string& source, const SpeedTrack& tracks, std::span<const TrackName> names) {
    return figure_over(source, {"joint speed", "deg/s"}, tracks.speed_deg_s, tracks, names,
                       [](const auto& line) { return line.spread_nm; });
}

}  // namespace ripplenotch
