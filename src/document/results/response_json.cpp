// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <utility>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/spectrum_json.hpp"

namespace ripplenotch {

namespace {

std::vector<double> in_decibels(std::vector<double> gain) {
    for (double& value : gain) value = decibels(value);
    return gain;
}

std::vector<double> predicted_db(const PredictedResponse& predicted) {
    std::vector<double> values;
    for (const std::complex<double>& at : predicted.at)
        values.push_back(decibels(portable::hypot(at.real(), at.imag())));
    return values;
}

std::vector<double> predicted_deg(const PredictedResponse& predicted) {
    std::vector<double> values;
    for (const std::complex<double>& at : predicted.at)
        values.push_back(portable::arg(at) * degrees_per_radian);
    return values;
}

void describe_row(JsonWriter& json, const ResponseReport& report, const ResponseRow& row) {
    constexpr double ms = 1e3;
    const FrequencyResponse& response = report.response;
    const std::size_t k = row.bin;
    json("hz", response.hz[k], six);
    json("determined", response.determined(k));
    json("gain_db", decibels(response.gain[k]), six);
    json("gain_low_db", decibels(response.gain_low[k]), six);
    json("gain_high_db", decibels(response.gain_high[k]), six);
    json("phase_deg", response.phase_deg[k], six);
    json("phase_error_deg", response.phase_error_deg[k], six);
    json("group_delay_ms", row.group_delay ? ms * row.group_delay->delay.value() : not_a_number, six);
    json("group_delay_error_ms", row.group_delay ? ms * row.group_delay->error.value() : not_a_number, six);
    json("phase_delay_ms", row.phase_delay ? ms * row.phase_delay->value() : not_a_number, six);
    json("coherence", response.coherence[k], six);
}

}  // namespace

std::string response_text(const ResponseReport& report, const Provenance& provenance) {
    const FrequencyResponse& response = report.response;
    return to_fitted_text(document_of("response", provenance, [&](JsonWriter& json) {
        json("verdict", response_verdict(report));
        json("notes", joined(response_notes(report), " "));
        json("joint", report.joint);
        json("out", report.out);
        json("in", report.in);
        json("gain_unit", report.unit);
        json("estimator", response.estimator == ResponseEstimator::h1 ? "h1" : "h2");
        json("window", "hann");
        json("segments", response.segments);
        json("independent_segments", response.independent_segments, six);
        json("segment_s", response.segment);
        json("resolution_hz", response.resolution, six);
        json("coherence_limit", response.coherence_limit, six);
        json("coherence_limit_anywhere", response.coherence_limit_anywhere, six);
        json("determined_bins", response.determined_bins());
        json.each("ranges", response.ranges, [&](JsonWriter& range, const BinRange& bins) {
            range("from_hz", response.hz[bins.first], six);
            range("to_hz", response.hz[bins.end - 1], six);
        });
        json.group_if("predicted", report.predicted, [&](JsonWriter& group, const PredictedResponse& one) {
            const Agreement found = agreement(response, one);
            group("method", one.method);
            group("filter", one.note);
            group("bins_within", found.within);
            group("largest_db", found.largest_db, six);
            group("largest_deg", found.largest_deg, six);
        });
        json.each("third_octaves", third_octaves(response),
                  [&](JsonWriter& row, const ResponseRow& one) { describe_row(row, report, one); });
        json.group("columns", [&](JsonWriter& columns) {
            columns("frequency_hz", response.hz, six);
            columns("gain_db", in_decibels(response.gain), six);
            columns("gain_low_db", in_decibels(response.gain_low), six);
            columns("gain_high_db", in_decibels(response.gain_high), six);
            columns("phase_deg", response.phase_deg, six);
            columns("phase_error_deg", response.phase_error_deg, six);
            columns("coherence", response.coherence, six);
            if (report.predicted) {
                columns("predicted_db", predicted_db(*report.predicted), six);
                columns("predicted_deg", predicted_deg(*report.predicted), six);
            }
        });
    }));
}

}  // namespace ripplenotch
