// SPDX-License-Identifier: MIT
#include "ripplenotch/document/simulation_json.hpp"

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"

namespace ripplenotch {

namespace {

std::string_view left_out_name(LeftOut left_out) {
    switch (left_out) {
        case LeftOut::fitted:
            return "fitted";
        case LeftOut::refused:
            return "refused";
        default:
            return "assumed";
    }
}

}  // namespace

void describe(JsonWriter& json, const SectionCheck& check) {
    json("band", check.band);
    json("speed_from_deg_s", check.from);
    json("speed_to_deg_s", check.to);
    json("section", check.section);
    json("order", check.order);
    json("center_hz", check.center);
    json("center_shift_percent", check.shift_percent);
    json("q", check.q);
    json.known("response_depth_db", check.is_notch, check.response_depth_db);
    json("depth_db", check.depth_db);
    json("dc_error_db", check.dc_error_db);
    json("mean_error_nm", check.mean_error_nm);
    json("pole_radius", check.pole_radius);
}

void describe(JsonWriter& json, const ExportReport& report) {
    json("target", report.target);
    json("file", report.file);
    json("bytes", report.bytes);
    json("sample_rate_hz", report.sample_rate);
    json("bands", report.bands);
    json("sections_per_band", report.sections_per_band);
    json("usage", report.usage);
    json("warnings", report.warnings);
    json("arithmetic", report.arithmetic);
    json("sections", report.checks);
    json("violations", report.violations);
}

void describe(JsonWriter& json, const Parameter& parameter) {
    json("name", parameter.name);
    json("unit", parameter.unit);
    json("neutral", parameter.neutral);
    json("first_guess", parameter.start);
    json("lower", parameter.lower);
    json("upper", parameter.upper);
    json("linear", parameter.linear);
    json("left_out", left_out_name(parameter.left_out));
    json("meaning", parameter.help);
}

void describe(JsonWriter& json, const LookAlike& other) {
    json("name", other.name);
    json("when", other.when);
    json("told_by", other.told_by);
}

void describe(JsonWriter& json, const Effect& effect) {
    json("effect", effect.name);
    json("side", side_name(effect.side));
    json("summary", effect.summary);
    json("equation", effect.equation);
    json("parameters", effect.parameters);
    json("symptom", effect.symptom);
    json("look_alikes", effect.look_alikes);
    json("source", effect.source);
}

void describe(JsonWriter& json, const Followed& followed) {
    json("smoothing_s", followed.smoothing);
    json("measured_rms_nm", followed.measured_rms_nm);
    json("residual_rms_nm", followed.residual_rms_nm, fitted);
}

void describe(JsonWriter& json, const Simulation& simulation) {
    const auto span = [](double least, double most) {
        return [least, most](JsonWriter& ends) {
            ends("min", least);
            ends("max", most);
        };
    };
    json("rows", simulation.rows);
    json("sample_rate_hz", simulation.sample_rate);
    json("duration_s", static_cast<double>(simulation.rows) / simulation.sample_rate.value());
    json("columns", simulation.columns);
    json("motions", simulation.motions);
    json("seed", simulation.seed);
    json("along_log", simulation.followed, if_any);
    json("noise_rms_nm", simulation.noise_rms);
    json("noise_correlation", simulation.noise_correlation);
    json("velocity_noise_rms_deg_s", simulation.velocity_noise_rms);
    json.group("torque_nm", span(simulation.torque_min_nm, simulation.torque_max_nm));
    json.group("speed_deg_s", span(simulation.speed_min_deg_s, simulation.speed_max_deg_s));
    json("gear", simulation.gear);
    json("model", simulation.model);
    json.group("output", [&](JsonWriter& output) {
        output("name", simulation.output);
        output("sha256", simulation.output_sha256);
    });
}

std::string export_report_to_json(const ExportReport& report, const Provenance& provenance) {
    return to_fitted_text(document_of("export", provenance, report));
}

std::string write_catalogue(std::span<const Effect* const> effects, const Provenance& provenance) {
    return to_text(document_of("effects", provenance, [&](JsonWriter& json) { json("effects", effects); }));
}

std::string write_simulation(const Simulation& simulation, const Provenance& provenance) {
    return to_text(document_of("simulation", provenance, simulation));
}

}  // namespace ripplenotch
