// SPDX-License-Identifier: MIT
#include "ripplenotch/document/results.hpp"

#include <algorithm>

#include "core/matrices/least_squares.hpp"
#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

void describe(auto& archive, Is<Doubt> auto& doubt) {
    archive("reason", doubt.reason, Names{doubt_name, DoubtReason::unit});
    archive("because", doubt.because);
}

void describe(auto& archive, Is<SearchedOrders::Bound> auto& bound) {
    archive("from_order", bound.from_order);
    archive("detectable_nm", bound.detectable_nm);
}

void describe(auto& archive, Is<SearchedOrders> auto& searched) {
    archive("lowest_order", searched.lowest_order);
    archive("highest_order", searched.highest_order);
    archive("detectable_nm", searched.detectable_nm);
    archive("bounds", searched.bounds);
}

void describe(auto& archive, Is<RatioCandidate> auto& candidate) {
    archive("value", candidate.value);
    archive("score", candidate.score);
    archive("reason", candidate.reason);
}

void describe(auto& archive, Is<GearRatioFit::Residual> auto& residual) {
    archive("speed_deg_s", residual.speed_deg_s);
    archive("hz", residual.hz);
    archive("order", residual.order);
    archive("residual_hz", residual.residual_hz, StepsOf{residual.hz});
    archive("weight", residual.weight);
}

void describe(auto& archive, Is<GearRatioFit> auto& fit) {
    archive("value", fit.value, above_zero_or_null);
    archive.known("stderr", fit.value.has_value(), fit.standard_error);
    archive.known("ci95", fit.value.has_value(), std::tie(fit.ci95_low, fit.ci95_high));
    archive("second_comb", fit.second_comb);
    archive("candidates", fit.candidates);
    archive("residuals", fit.residuals, if_there);
}

void describe(auto& archive, Is<OtherMotorRipple::AtOrder> auto& at) {
    archive("order", at.order);
    archive("found", at.found);
    archive.known("amplitude_nm", at.found, at.amplitude_nm);
    archive.known("stderr_nm", at.found, at.standard_error_nm);
    archive("detectable_nm", at.detectable_nm);
}

void describe(auto& archive, Is<OtherMotorRipple> auto& motor) {
    archive("joint", motor.joint);
    archive("gear_ratio", motor.gear_ratio, above_zero);
    archive("orders", motor.orders);
    archive("doubt", motor.doubt, if_any);
}

void describe(auto& archive, Is<AmplitudeAtSpeed> auto& at) {
    archive("speed_deg_s", at.speed_deg_s);
    archive("hz", at.hz);
    archive("amplitude_nm", at.amplitude_nm);
    archive("snr", at.snr);
}

template <class Archive>
void describe(Archive& archive, Is<Line> auto& line) {
    archive("kind", line.kind, Names{line_kind_name, LineKind::unknown});
    archive("order", line.order);
    archive("order_output", line.order_output);
    archive("order_output_stderr", line.order_output_stderr);
    archive("hz", line.hz);
    archive("amplitude_nm", line.amplitude_nm);
    const bool phase_known = archive.known("phase_deg", line.phase_known, line.phase_deg);
    if constexpr (Archive::reading) line.phase_known = phase_known;
    archive("snr", line.snr);
    archive("speed_range_deg_s", std::tie(line.speed_from_deg_s, line.speed_to_deg_s));
    archive("amplitude_by_speed", line.by_speed);
    archive("note", line.note, if_there);
}

void describe(auto& archive, Is<VelocityError> auto& error) {
    archive("offset_deg_s", error.offset, StepsOf{10.0 * error.offset_error.value()});
    archive("offset_stderr_deg_s", error.offset_error);
}

void describe(auto& archive, Is<Disagreement::Value> auto& value) {
    archive("recording", value.recording);
    archive("value", value.value);
    archive("stderr", value.error);
}

void describe(auto& archive, Is<Disagreement> auto& one) {
    archive("about", one.about, Names{about_name, Disagreement::About::amplitude});
    archive("order", one.order);
    archive("order_output", one.order_output);
    archive("chance", one.chance);
    archive("values", one.values);
}

template <class Archive>
void describe(Archive& archive, Is<RippleAtSpeed> auto& at) {
    auto& ripple = at.ripple;
    archive("order", ripple.order);
    if constexpr (Archive::reading)
        at.direction = archive.number("direction") < 0.0 ? -1 : 1;
    else
        archive("direction", at.direction);
    archive("speed_deg_s", at.speed_deg_s);
    archive("speed_range_deg_s", std::tie(at.speed_from_deg_s, at.speed_to_deg_s));
    archive("segments", ripple.segments);
    archive("amplitude_nm", ripple.amplitude_nm);
    const double half = normal_95_errors * ripple.standard_error_nm;
    double low = std::max(0.0, ripple.amplitude_nm - half), high = ripple.amplitude_nm + half;
    archive("ci95_nm", std::tie(low, high));
    if constexpr (Archive::reading)
        ripple.standard_error_nm = (high - ripple.amplitude_nm) / normal_95_errors;
    archive("detectable_nm", ripple.detectable_nm);
    archive("false_alarm", ripple.false_alarm);
}

// Older files tell the finding in words alone, and nothing of what is read only if it is there.
void describe(auto& archive, Is<Identification> auto& found) {
    archive("verdict", found.verdict);
    archive("finding", found.finding, Names{finding_name, RippleFinding::too_little}, if_there);
    archive("doubts", found.doubts, if_there);
    archive("conclusive", found.conclusive);
    archive("joint", found.joint, if_there);
    archive("sample_rate_hz", found.sample_rate, above_zero);
    archive("evidence", found.evidence);
    archive("searched", found.searched);
    archive("gear_ratio", found.gear_ratio);
    archive.derived("gear", [&] { return found_gear(found); });
    archive("lines", found.lines, AtMost{most_lines});
    archive("velocity_error", found.velocity_error);
    archive("velocity_noise_deg_s", found.velocity_noise, if_any);
    archive("disagreements", found.disagreements, if_there);
    if (archive.holds("other_motors", !found.other_motors.empty())) {
        archive("other_motors", found.other_motors);
        archive("other_motors_not_known", found.other_motors_not_known);
    }
    archive("amplitude_by_speed_and_direction", found.by_speed, if_there);
    archive("notes", found.notes);
}

Identification identification_from_json(std::string_view text, const std::string& source) {
    return result_of<Identification>(text, source, "joint");
}

Identification load_identification(const std::string& path) {
    return identification_from_json(read_all(path), input_name(path));
}

std::string identification_text(const Identification& identification, const Provenance& provenance) {
    return to_fitted_text(document_of("joint", provenance, identification));
}

std::string identifications_text(std::span<const Identification> identifications,
                                 const Provenance& provenance) {
    return to_fitted_text(
        document_of("joints", provenance, [&](JsonWriter& json) { json("joints", identifications); }));
}

}  // namespace ripplenotch
