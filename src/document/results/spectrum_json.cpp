// SPDX-License-Identifier: MIT
#include "ripplenotch/document/spectrum_json.hpp"

#include <algorithm>
#include <utility>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

std::string speed_map_text(const std::string& joint, const SpeedMap& map, std::string_view axis_name,
                           const std::optional<GearAccount>& gear, const Provenance& provenance) {
    return to_fitted_text(document_of("spectrum", provenance, [&](JsonWriter& json) {
        json("joint", joint);
        json("domain", map.axis_kind == Axis::time ? "campbell" : "order-map");
        json("gear", gear);
        json("window", "hann");
        json("resolution", map.resolution, six);
        json("speed_step_deg_s", map.speed_step_deg_s);
        json("runs_too_short", map.runs_too_short);
        json("axis", axis_name);
        json("axis_values", map.axis, six);
        json.each("rows", map.speed_deg_s, [&](JsonWriter& row, const double& speed_deg_s) {
            const auto i = static_cast<std::size_t>(&speed_deg_s - map.speed_deg_s.data());
            row("speed_deg_s", speed_deg_s, six);
            row("windows", map.windows[i]);
            row("amplitude_nm", map.amplitude_nm[i], six);
        });
    }));
}

namespace {

void write_tracked_line(JsonWriter& json, const TrackReport& report, std::size_t i) {
    const TrackLabel& label = report.labels[i];
    const TrackSummary line = track_summary(report, i);
    const bool measured = line.rows > 0;
    json("name", label.column());
    json.known("order", label.kind == TrackLabel::Kind::order, label.value);
    json.known("order_output", label.kind == TrackLabel::Kind::order_output, label.value);
    json.known("hz", label.kind == TrackLabel::Kind::tone, label.value);
    json("ripple", report.ripple[i]);
    json("rows_measured", line.rows);
    json.known("median_nm", measured, line.median_nm);
    json.known("least_nm", measured, line.least_nm);
    json.known("greatest_nm", measured, line.greatest_nm);
}

}  // namespace

void describe(JsonWriter& json, const TrackReport& report) {
    json("verdict", report.doubt + track_verdict(report));
    json("joint", report.joint);
    json("against", report.by_speed ? "speed" : "time");
    json.known("gear_ratio", report.gear && report.gear->has_ratio(),
               report.gear ? report.gear->ratio : GearRatio());
    json("gear", report.gear);
    json("angle", report.angle_from_position ? "position" : "integrated velocity");
    json("window_turns", report.window_turns);
    json("window_s", report.window);
    json.known("speed_step_deg_s", report.by_speed.has_value(),
               report.by_speed ? report.by_speed->step_deg_s : 0.0);
    json("residual_rms_nm", report.tracks.residual_rms_nm);
    json("rows_folded", report.tracks.rows_folded);
    json("rows_not_separable", report.tracks.rows_not_separable);
    json("windows_too_few_samples", report.tracks.windows_too_few_samples);
    json.each("lines", report.labels, [&](JsonWriter& line, const TrackLabel& label) {
        write_tracked_line(line, report, static_cast<std::size_t>(&label - report.labels.data()));
    });
    json.group("columns", [&](JsonWriter& columns) {
        for (const TrackColumn& column : track_columns(report)) columns(column.name, column.values);
    });
}

std::string track_text(const TrackReport& report, const Provenance& provenance) {
    return to_fitted_text(document_of("track", provenance, report));
}

void describe(JsonWriter& json, const SpectralPeak& peak) {
    json("hz", peak.hz);
    json("hz_stderr", peak.hz_stderr);
    json("amplitude_nm", peak.amplitude_nm);
    json("phase_deg", peak.phase_deg);
    json("floor_nm", peak.floor_nm);
    json("snr", peak.snr);
    json("false_alarm", peak.false_alarm);
}

void describe(JsonWriter& json, const MotionLine& line) {
    const bool tone = line.kind == LineKind::tone;
    json("kind", line_kind_name(line.kind));
    json.known("order_output", !tone, line.order_output);
    json.known("order_output_stderr", !tone, line.order_stderr);
    json.known("hz", line.kind != LineKind::order, line.hz);
    json("amplitude_nm", line.amplitude_nm);
    json("phase_deg", line.phase_deg);
    json("floor_nm", line.floor_nm);
    json("snr", line.snr);
    json("false_alarm", line.false_alarm);
}

double median_floor(const std::vector<double>& floor_nm) {
    std::vector<double> known;
    std::copy_if(floor_nm.begin(), floor_nm.end(), std::back_inserter(known),
                 [](double value) { return value > 0.0; });
    if (known.empty()) return 0.0;
    return median_in(known);
}

void describe(JsonWriter& json, const LogSpectrum& one) {
    json("rows", one.stretch.count);
    json("duration_s", one.stretch.duration);
    json("speed_deg_s", one.stretch.speed);
    json("turning_deg_s", one.stretch.turning_deg_s);
    json("turning_spread_deg_s", one.stretch.turning_spread_deg_s);
    json("pieces", one.spectrum.pieces);
    json("piece_duration_s", one.spectrum.piece_duration);
    json("bin_width_hz", one.spectrum.bin_width);
    json("resolution_hz", one.spectrum.resolution);
    json("noise_floor_nm", median_floor(one.spectrum.floor_nm));
    json("peaks", one.spectrum.peaks);
}

std::string spectrum_text(const std::string& joint, const LogSpectrum& spectrum, double false_alarm,
                          const Provenance& provenance) {
    return to_fitted_text(document_of("spectrum", provenance, [&](JsonWriter& json) {
        json("joint", joint);
        json("domain", "frequency");
        json("window", "hann");
        json("false_alarm", false_alarm);
        json("spectra", std::span(&spectrum, 1));
    }));
}

std::string order_spectrum_text(const std::string& joint, const OrderSpectrum& spectrum, double false_alarm,
                                const Provenance& provenance) {
    return to_fitted_text(document_of("spectrum", provenance, [&](JsonWriter& json) {
        json("joint", joint);
        json("domain", "order");
        json("window", "hann");
        json("false_alarm", false_alarm);
        json("doubt", spectrum.doubt);
        json("sweeps", spectrum.lines.sweeps);
        json("output_turns", spectrum.lines.turns);
        json("speed_range_deg_s", std::tie(spectrum.lines.slowest_deg_s, spectrum.lines.fastest_deg_s));
        json("bin_width_orders", spectrum.stack.spacing);
        json("resolution_orders", spectrum.stack.resolution);
        json("noise_floor_nm", median_floor(spectrum.stack.floor_nm));
        json("lines", spectrum.lines.lines);
    }));
}

}  // namespace ripplenotch
