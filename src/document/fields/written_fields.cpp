// SPDX-License-Identifier: MIT
#include "document/fields/written_fields.hpp"

namespace ripplenotch {
namespace {

Json mjcf_json(const MjcfAccount& mjcf) {
    Json holds = Json::array(), not_held = Json::array();
    for (const MjcfPart& part : mjcf.holds) holds.push_back({{"effect", part.effect}, {"as", part.words}});
    for (const MjcfPart& part : mjcf.not_held)
        not_held.push_back({{"effect", part.effect}, {"reason", part.words}});
    return {{"file", mjcf.file},
            {"holds", holds},
            {"not_held", not_held},
            {"gap_before_nm", six_digits(mjcf.before_nm)},
            {"gap_after_nm", six_digits(mjcf.after_nm)}};
}

Json plan_json(const MotionPlan& plan, const std::string& file) {
    Json questions = Json::array();
    for (const PlanQuestion& one : plan.questions)
        questions.push_back({{"effect", one.effect},
                             {"rival", one.rival.empty() ? Json(nullptr) : Json(one.rival)},
                             {"open", one.open},
                             {"gain_before", six_digits(one.gain_before)},
                             {"gain", six_digits(one.gain)}});
    return {{"file", file},
            {"duration_s", plan.duration().value()},
            {"decides", plan.decides},
            {"motions", plan.motions},
            {"questions", questions}};
}

}  // namespace

void put_written(Json& json, const DiagnosisWritten& written) {
    if (written.mjcf != nullptr) json["mjcf"] = mjcf_json(*written.mjcf);
    if (written.plan != nullptr)
        json["plan"] = plan_json(*written.plan, written.plan_file);
    else if (!written.plan_file.empty())
        json["plan"] = nullptr;
}

}  // namespace ripplenotch
