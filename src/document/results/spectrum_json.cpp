// SPDX-License-Identifier: MIT
#include "ripplenotch/document/spectrum_json.hpp"

#include <algorithm>
#include <utility>

#include "document/fields/document_head.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/median.hpp"

namespace ripplenotch {
namespace {

Json peak_to_json(const SpectralPeak& peak) {
    return {{"hz", peak.hz},
            {"hz_stderr", peak.hz_stderr},
            {"amplitude_nm", peak.amplitude_nm},
            {"phase_deg", peak.phase_deg},
            {"floor_nm", peak.floor_nm},
            {"snr", peak.snr},
            {"false_alarm", peak.false_alarm}};
}

Json hump_to_json(const SpectralHump& hump) {
    return {{"from_hz", hump.from_hz},        {"to_hz", hump.to_hz},   {"peak_hz", hump.peak_hz},
            {"peak_nm", hump.peak_nm},        {"rms_nm", hump.rms_nm}, {"floor_nm", hump.floor_nm},
            {"false_alarm", hump.false_alarm}};
}

Json motion_line_to_json(const MotionLine& line) {
    Json json = Json::object();
    json["kind"] = line_kind_name(line.kind);
    const bool tone = line.kind == LineKind::tone;
    json["order_output"] = tone ? Json(nullptr) : Json(line.order_output);
    json["order_output_stderr"] = tone ? Json(nullptr) : Json(line.order_stderr);
    json["hz"] = line.kind == LineKind::order ? Json(nullptr) : Json(line.hz);
    json["amplitude_nm"] = line.amplitude_nm;
    json["phase_deg"] = line.phase_deg ? Json(*line.phase_deg) : Json(nullptr);
    json["floor_nm"] = line.floor_nm;
    json["snr"] = line.snr;
    json["false_alarm"] = line.false_alarm;
    return json;
}

Json head(std::string_view domain, const std::string& joint, double false_alarm,
          const Provenance& provenance) {
    Json json = document_head("spectrum", provenance);
    json["joint"] = joint;
    json["domain"] = domain;
    json["window"] = "hann";
    json["false_alarm"] = false_alarm;
    return json;
}

}  // namespace

double median_floor(const std::vector<double>& floor_nm) {
    std::vector<double> known;
    std::copy_if(floor_nm.begin(), floor_nm.end(), std::back_inserter(known),
                 [](double value) { return value > 0.0; });
    if (known.empty()) return 0.0;
    return median_in(known);
}

std::string spectra_text(const std::string& joint, const std::vector<StretchSpectrum>& spectra,
                         double false_alarm, const Provenance& provenance) {
    Json json = head("frequency", joint, false_alarm, provenance);
    json["spectra"] = Json::array();
    for (const StretchSpectrum& one : spectra) {
        Json entry = Json::object();
        entry["stretch"] = one.number ? Json(*one.number) : Json(nullptr);
        entry["first_row"] = one.stretch.first;
        entry["rows"] = one.stretch.count;
        entry["duration_s"] = one.stretch.duration.value();
        entry["speed_deg_s"] = one.stretch.speed.value();
        entry["turning_deg_s"] = one.stretch.turning_deg_s;
        entry["turning_spread_deg_s"] = one.stretch.turning_spread_deg_s;
        entry["pieces"] = one.spectrum.pieces;
        entry["piece_duration_s"] = one.spectrum.piece_duration.value();
        entry["bin_width_hz"] = one.spectrum.bin_width.value();
        entry["resolution_hz"] = one.spectrum.resolution.value();
        entry["noise_floor_nm"] = median_floor(one.spectrum.floor_nm);
        entry["peaks"] = Json::array();
        for (const SpectralPeak& peak : one.spectrum.peaks)
            list_in(entry, "peaks").push_back(peak_to_json(peak));
        entry["humps"] = Json::array();
        for (const SpectralHump& hump : one.spectrum.humps)
            list_in(entry, "humps").push_back(hump_to_json(hump));
        list_in(json, "spectra").push_back(std::move(entry));
    }
    return to_fitted_text(std::move(json));
}

std::string order_spectrum_text(const std::string& joint, const OrderSpectrum& spectrum, double false_alarm,
                                const Provenance& provenance) {
    Json json = head("order", joint, false_alarm, provenance);
    json["doubt"] = spectrum.doubt;
    json["sweeps"] = spectrum.lines.sweeps;
    json["output_turns"] = spectrum.lines.turns;
    json["speed_range_deg_s"] = {spectrum.lines.slowest_deg_s, spectrum.lines.fastest_deg_s};
    json["bin_width_orders"] = spectrum.stack.spacing;
    json["resolution_orders"] = spectrum.stack.resolution;
    json["noise_floor_nm"] = median_floor(spectrum.stack.floor_nm);
    json["lines"] = Json::array();
    for (const MotionLine& line : spectrum.lines.lines)
        list_in(json, "lines").push_back(motion_line_to_json(line));
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
