// SPDX-License-Identifier: MIT
#include "page/key_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "page/json_words.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_numbers = 3;

// Empty where there is no number.
std::optional<double> number_under(const Json& json, const char* pointer) {
    const Json::json_pointer at(pointer);
    if (!json.contains(at) || !json.at(at).is_number()) return std::nullopt;
    return json.at(at).get<double>();
}

const Json& list_at(const Json& json, const char* name) {
    static const Json none = Json::array();
    const auto found = json.find(name);
    return found != json.end() && found->is_array() ? *found : none;
}

// Smallest and largest of a field over the rows.
std::optional<std::pair<double, double>> extremes(const Json& rows, const char* pointer) {
    std::optional<std::pair<double, double>> found;
    for (const Json& row : rows) {
        const auto value = number_under(row, pointer);
        if (!value) continue;
        if (!found) found = {*value, *value};
        found->first = std::min(found->first, *value);
        found->second = std::max(found->second, *value);
    }
    return found;
}

std::string from_to(const std::pair<double, double>& ends) {
    return fmt::format("{:.4g} to {:.4g}", ends.first, ends.second);
}

class Numbers {
  public:
    explicit Numbers(const Json& json) : json_(json) {}

    void add(const char* name, const char* pointer, const char* unit) {
        if (const auto value = number_under(json_, pointer)) add_text(name, coarse_text(*value), unit);
    }
    void add_text(const std::string& name, const std::string& value, const char* unit) {
        if (facts_.size() < most_numbers)
            facts_.push_back({name, *unit == 0 ? value : fmt::format("{} {}", value, unit)});
    }
    [[nodiscard]] std::vector<PageFact> taken() { return std::move(facts_); }

  private:
    const Json& json_;
    std::vector<PageFact> facts_;
};

void of_joint(const Json& json, Numbers& numbers) {
    const auto ratio = json.find("gear_ratio");
    if (ratio != json.end() && number_under(*ratio, "/value"))
        numbers.add_text("gear ratio", field_text(*ratio, "value"), "");
    for (const Json& line : list_at(json, "lines")) {
        const auto order = number_under(line, "/order");
        const auto amplitude = number_under(line, "/amplitude_nm");
        if (order && amplitude)
            numbers.add_text(fmt::format("order {:.4g}, zero to peak", *order), coarse_text(*amplitude),
                             "Nm");
    }
}

void of_table(const Json& json, Numbers& numbers) {
    const Json& bands = list_at(json, "bands");
    if (!bands.empty()) numbers.add_text("bands", std::to_string(bands.size()), "");
    if (const auto delay = extremes(bands, "/dc_delay_ms"))
        numbers.add_text("delay at 0 Hz", from_to(*delay), "ms");
    if (const auto held = extremes(bands, "/held_attenuation_db"))
        numbers.add_text("least attenuation", coarse_text(held->first), "dB");
}

void of_metrics(const Json& json, Numbers& numbers) {
    numbers.add("ripple before, peak to peak", "/ripple_peak_to_peak_nm/raw", "Nm");
    numbers.add("ripple after, peak to peak", "/ripple_peak_to_peak_nm/filtered", "Nm");
    if (const auto delay = extremes(list_at(json, "delays"), "/dc_delay_ms"))
        numbers.add_text("delay at 0 Hz", from_to(*delay), "ms");
}

// Of the first method beside the control, which the table calls A.
void of_comparison(const Json& json, Numbers& numbers) {
    for (const Json& method : list_at(json, "methods")) {
        if (!method.is_object() || method.value("method", Json("none")) == "none") continue;
        Numbers own(method);
        own.add("A settles to 0.5 %", "/settle_ms/0.5", "ms");
        own.add("A delays a ramp by", "/ramp_delay_ms", "ms");
        own.add("A leaves of the ripple, rms", "/ripple_rms_nm", "Nm");
        for (const PageFact& fact : own.taken()) numbers.add_text(fact.name, fact.value, "");
        return;
    }
}

void of_diagnosis(const Json&, Numbers& numbers) {
    numbers.add("gap before, rms", "/gap/before_nm", "Nm");
    numbers.add("gap after, rms", "/gap/after_nm", "Nm");
    numbers.add("noise floor, rms", "/gap/noise_floor_nm", "Nm");
}

// Of each order of the map: what is left of it on blocks that the map was not fitted to.
void of_map(const Json& json, Numbers& numbers) {
    for (const Json& line : list_at(json, "left_out")) {
        const auto order = number_under(line, "/order"), left = number_under(line, "/left_nm"),
                   was = number_under(line, "/ripple_nm");
        if (order && left && was)
            numbers.add_text(fmt::format("order {:.4g} before and after", *order),
                             fmt::format("{:.3g} to {:.3g}", *was, *left), "Nm");
    }
}

// Of the method that it says to take.
void of_recommendation(const Json& json, Numbers& numbers) {
    const auto take = json.find("take");
    for (const Json& method : list_at(json, "methods")) {
        if (take == json.end() || !method.is_object() || method.value("method", Json()) != *take) continue;
        if (const auto off = extremes(list_at(method, "attenuation_db"), "/db"))
            numbers.add_text("least attenuation", fmt::format("{:.1f}", off->first), "dB");
        if (const auto late = number_under(method, "/longest_delay_ms"))
            numbers.add_text("late at most", fmt::format("{:.1f}", *late), "ms");
        if (const auto left = number_under(method, "/ripple_rms_nm"))
            numbers.add_text("ripple left, rms", coarse_text(*left), "Nm");
        return;
    }
}

void of_trend(const Json& json, Numbers& numbers) {
    numbers.add_text("alerts", std::to_string(list_at(json, "alerts").size()), "");
    numbers.add_text("joints", std::to_string(list_at(json, "joints").size()), "");
    numbers.add("alerts by chance alone, at most", "/expected_false_alarms", "");
}

// The first numbers of a kind that is not looked into.
void of_any(const Json& json, Numbers& numbers) {
    for (const auto& [name, entry] : json.items()) {
        const Spoken said = spoken(name);
        if (entry.is_number()) numbers.add_text(said.name, field_text(json, name), said.unit.c_str());
    }
}

struct Kind {
    const char *name, *question;
    void (*numbers)(const Json&, Numbers&);
};
constexpr std::array<Kind, 13> kinds = {
    {{"info", "What is in the log?", of_any},
     {"joint", "Which ripple is in the log, and which gear ratio?", of_joint},
     {"spectrum", "Which frequencies are in the torque?", of_any},
     {"track", "How does the ripple change along the log?", of_any},
     {"map", "What is the ripple at each angle and speed?", of_map},
     {"recommendation", "Which method does this log ask for?", of_recommendation},
     {"trend", "Which joint changed, when, and what in it?", of_trend},
     {"table", "Which notches at which speed, and at what delay?", of_table},
     {"metrics", "What did the filter take off?", of_metrics},
     {"comparison", "What do the methods take off, and what do they cost?", of_comparison},
     {"diagnosis", "Which effect is missing from the model?", of_diagnosis},
     {"simulation", "What was simulated?", of_any},
     {"export", "What was exported, and what did rounding do to it?", of_any}}};

const Kind* kind_named(const std::string& name) {
    const auto* found =
        std::find_if(kinds.begin(), kinds.end(), [&](const Kind& kind) { return name == kind.name; });
    return found == kinds.end() ? nullptr : found;
}

}  // namespace

std::string question_of(const std::string& kind) {
    const Kind* known = kind_named(kind);
    return known != nullptr ? known->question : kind;
}

std::string sentence_of(const std::string& kind, const Json& result) {
    if (kind == "table") {
        const Json& bands = list_at(result, "bands");
        const auto delay = extremes(bands, "/dc_delay_ms"), from = extremes(bands, "/speed_from_deg_s"),
                   to = extremes(bands, "/speed_to_deg_s");
        if (!delay || !from || !to) return "";
        return fmt::format("{} band{} of notches from {:.4g} to {:.4g} deg/s; the torque lags by {} ms.",
                           bands.size(), bands.size() == 1 ? "" : "s", from->first, to->second,
                           delay->first == delay->second ? coarse_text(delay->first) : from_to(*delay));
    }
    if (kind == "metrics") {
        const auto before = number_under(result, "/ripple_peak_to_peak_nm/raw"),
                   after = number_under(result, "/ripple_peak_to_peak_nm/filtered");
        if (!before || !after) return "";
        return fmt::format("The ripple is at most {:.3g} Nm peak to peak before the filter, {:.3g} Nm after.",
                           *before, *after);
    }
    return "";
}

std::vector<PageFact> key_numbers(const std::string& kind, const Json& result) {
    Numbers numbers(result);
    const Kind* known = kind_named(kind);
    (known != nullptr ? known->numbers : of_any)(result, numbers);
    return numbers.taken();
}

}  // namespace ripplenotch
