// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/track_figure.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ripplenotch/analysis/track_report.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_ribbon_rows = 2000;

Ink track_ink(const TrackName& line) {
    if (line.order) return order_ink(*line.order);
    return line.is_tone ? tone_ink : unknown_ink;
}

CurveStyle track_style(const TrackName& line, CurveStyle style) {
    return line.order ? order_style(*line.order, style) : other_mark(style);
}

struct TrackPanels {
    Panel amplitude, phase;
};

TrackPanels panels_over(const PlotAxis& x, const TrackScale& scale) {
    TrackPanels panels{{.title = "Amplitude", .x = x, .y = {scale.label, "Nm"}},
                       {.title = "Phase against the angle of the shaft",
                        .x = x,
                        .y = {"phase", "deg"},
                        .legend = false,
                        .height = 0.7}};
    panels.amplitude.y.from = 0.0;
    panels.phase.y.from = -180.0;
    panels.phase.y.to = 180.0;
    return panels;
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

void add_line(TrackPanels& panels, const TrackName& line, const std::vector<double>& x,
              std::vector<double> amplitude_nm, const std::vector<double>& half_width_nm,
              const std::vector<double>& phase_deg, const std::vector<std::size_t>& breaks,
              const TrackScale& scale) {
    const Ink ink = track_ink(line);
    Ribbon ribbon{"", ink, x, {}, {}};
    for (std::size_t i = 0; i < x.size(); ++i) {
        amplitude_nm[i] *= scale.factor;
        ribbon.low.push_back(std::max(0.0, amplitude_nm[i] - scale.factor * half_width_nm[i]));
        ribbon.high.push_back(amplitude_nm[i] + scale.factor * half_width_nm[i]);
    }
    // A ribbon of more rows than a picture has columns would be a blur.
    if (x.size() <= most_ribbon_rows) {
        for (Ribbon& part : parts_of(ribbon, breaks)) panels.amplitude.ribbons.push_back(std::move(part));
    }
    Curve amplitude{line.words, ink, track_style(line, CurveStyle::line), x, std::move(amplitude_nm)};
    break_at(breaks, amplitude);
    panels.amplitude.curves.push_back(thinned(amplitude));
    panels.phase.curves.push_back(
        thinned({line.words, ink, track_style(line, CurveStyle::points), x, phase_deg}));
}

Figure figure_of(const std::string& source, TrackPanels panels) {
    return {"track",
            fmt::format("Lines of the torque along the log: {}", source),
            "",
            {std::move(panels.amplitude), std::move(panels.phase)}};
}

}  // namespace

Figure track_figure(const std::string& source, const OrderTracks& tracks, std::span<const TrackName> names,
                    const TrackScale& scale) {
    TrackPanels panels = panels_over({"time", "s"}, scale);
    const std::vector<std::size_t> breaks = track_breaks(tracks);
    for (std::size_t i = 0; i < tracks.lines.size(); ++i) {
        std::vector<double> twice = tracks.lines[i].standard_error_nm;
        for (double& error : twice) error *= 2.0;
        add_line(panels, names[i], tracks.time_s, tracks.lines[i].amplitude_nm, twice,
                 tracks.lines[i].phase_deg, breaks, scale);
    }
    return figure_of(source, std::move(panels));
}

Figure track_figure(const std::string& source, const SpeedTrack& tracks, std::span<const TrackName> names,
                    const TrackScale& scale) {
    TrackPanels panels = panels_over({"joint speed", "deg/s"}, scale);
    const std::vector<std::size_t> breaks = track_breaks(tracks);
    for (std::size_t i = 0; i < tracks.lines.size(); ++i) {
        add_line(panels, names[i], tracks.speed_deg_s, tracks.lines[i].amplitude_nm,
                 tracks.lines[i].spread_nm, tracks.lines[i].phase_deg, breaks, scale);
    }
    return figure_of(source, std::move(panels));
}

}  // namespace ripplenotch
