// SPDX-License-Identifier: MIT
#include "page/diagnosis_rounds.hpp"

#include "document/fields/diagnosis_fields.hpp"
#include "page/json_table.hpp"
#include "page/json_words.hpp"

namespace ripplenotch {
namespace {

std::string gap_from_to(double before_nm, double after_nm) {
    return fmt::format("{} to {}", coarse_text(before_nm), coarse_text(after_nm));
}

Json row_of(const Finding& finding) {
    Json row{{"effect", finding.term.effect->name}, {"status", status_name(finding.status)}};
    if (!finding.reason.empty()) row["reason"] = finding.reason;
    row["parameters"] = parameters_json(finding.term, finding.values);
    row["where"] = place_json(finding.where);
    row["explains_nm"] = finite_or_null(finding.evidence.share_nm);
    row["gap_nm"] = gap_from_to(finding.gap_before_nm, finding.gap_after_nm);
    if (finding.validation_before_nm)
        row["validation_nm"] = gap_from_to(*finding.validation_before_nm, *finding.validation_after_nm);
    std::string rivals;
    for (const RivalFinding& rival : finding.alternatives)
        rivals += fmt::format("{}{}", rivals.empty() ? "" : ", ", rival.effect);
    if (!rivals.empty()) row["rivals"] = rivals;
    return row;
}

}  // namespace

PageTable rounds_table(const Diagnosis& diagnosis) {
    Json rows = Json::array();
    for (const Finding& finding : diagnosis.rounds) rows.push_back(row_of(finding));
    return table_of("rounds", rows);
}

}  // namespace ripplenotch
