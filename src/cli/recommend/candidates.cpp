// SPDX-License-Identifier: MIT
#include "cli/recommend/candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "cli/options/lists.hpp"
#include "cli/options/options.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/map_json.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

namespace {

constexpr std::string_view map_file = "map.json";

// " --gear-ratio 100 --orders 1,2", " --orders 200/turn"
std::string gear_words(const GearAccount& gear) {
    const std::string ratio = gear.has_ratio() ? " --gear-ratio " + shortest(gear.ratio.value()) : "";
    return ratio + " --orders " + orders_text(gear.orders, gear.ratio, ",");
}

// A name for the filtered log beside this one: "filtered.csv".
std::string filtered_name(const std::string& log) {
    // A name that the filtered log can keep; others hold what is not written or is packed.
    static const std::set<std::string> written = {".csv", ".txt", ".npy", ".mat", ".h5"};
    const std::string ending = std::filesystem::path(log).extension().string();
    return "filtered" + (written.contains(ending) ? ending : ".csv");
}

struct MovingSpeeds {
    DegPerSec slowest, median, fastest;
};

// Of the rows that move; the slowest leaves out the starts and stops. Empty at standstill.
std::optional<MovingSpeeds> moving_speeds(const TraceView& trace) {
    const DegPerSec median = median_moving_speed(trace);
    std::vector<double> speeds;
    for (const double v : trace.velocity_deg_s)
        if (std::abs(v) > 0.2 * median.value()) speeds.push_back(std::abs(v));
    if (speeds.empty()) return std::nullopt;
    std::sort(speeds.begin(), speeds.end());
    return MovingSpeeds{DegPerSec(speeds[speeds.size() / 20]), median, DegPerSec(speeds.back())};
}

class Maker {
  public:
    explicit Maker(const CandidateRequest& request) : request_(request), view_(request.train.trace.view()) {}

    TriedMethods all() {
        const auto extent = moving_speeds(view_);
        if (extent) fit_map();
        for (const Method* method : methods()) {
            if (method->trials == nullptr)
                add(std::string(method->name));
            else if (extent)
                try_settings(*method, *extent);
        }
        if (!extent) made_.leave_out("the joint does not move in the part that methods learn from");
        return std::move(made_);
    }

  private:
    void try_settings(const Method& method, const MovingSpeeds& speeds) {
        const Trials trials =
            method.trials({request_.gear, request_.sample_rate, request_.train.recording.update_rate(),
                           speeds.slowest, speeds.median, speeds.fastest, map_ ? std::string(map_file) : ""});
        if (!trials.none_because.empty())
            made_.leave_out(fmt::format("{}: {}", method.name, trials.none_because));
        for (const Trial& trial : trials.all) {
            const std::string text = std::string(method.name) + trial.settings;
            if (trial.table)
                add_table(text, *trial.table);
            else if (const auto held =
                         method.is_map && request_.target ? request_.target->held(*map_) : std::nullopt)
                add_held(std::string(method.name), *held);
            else
                add(text);
        }
    }

    void take(Contender contender) {
        if (contender.method->part != MethodPart::control && request_.target) {
            const std::string why = request_.target->refusal(contender, request_.sample_rate);
            if (!why.empty()) {
                made_.leave_out(fmt::format("{} does not fit into {}: {}", contender.method->name,
                                            request_.target->spec.name, why));
                return;
            }
        }
        made_.contenders.push_back(std::move(contender));
    }

    void add(const std::string& text) {
        take(
            choose_method(text, std::nullopt, request_.choice, [this](const std::string&) { return *map_; }));
    }

    void add_held(std::string text, const RippleMap& held) {
        for (const auto& [key, value] : map_as_keys(held)) text += "," + key + "=" + value;
        add(text);
    }

    // What a method reads is what stands in the file, not what was fitted.
    void fit_map() {
        MapFit fit = fit_ripple_map({&view_, 1}, request_.gear);
        fit.map.joint = request_.train.trace.joint;
        if (fit.map.orders.empty() || !fit.anchored) {
            made_.leave_out("a ripple map: " +
                            (fit.map.orders.empty()
                                 ? map_verdict(fit)
                                 : std::string("the log has no position that ties the motor's angle")));
            return;
        }
        map_ = map_from_json(map_text(fit, {}), std::string(map_file)).map;
        made_.files.push_back(
            {std::string(map_file), fmt::format("ripplenotch map {}{} -o {}", request_.train_words,
                                                gear_words(request_.gear), map_file)});
    }

    void add_table(const std::string& text, const TableSpec& spec) {
        Contender contender = make_contender(
            parse_spec(text), std::make_shared<const CandidateTable>(CandidateTable::design(spec)));
        const std::string file = contender.settings.text("table");
        contender.gear = request_.gear;
        contender.files = {file};
        take(std::move(contender));
        const auto& [slowest_from, slowest_to] = spec.bands.front();
        made_.files.push_back(
            {file, fmt::format("ripplenotch design{} --sample-rate {}Hz --speed {}:{}:{} --q {} -o {}",
                               gear_words(request_.gear), shortest(spec.sample_rate.value()),
                               shortest(slowest_from.value()), shortest(spec.bands.back().second.value()),
                               shortest((slowest_to - slowest_from).value()), shortest(spec.q), file)});
    }

    const CandidateRequest& request_;
    TraceView view_;
    std::optional<RippleMap> map_;
    TriedMethods made_;
};

}  // namespace

void TriedMethods::leave_out(const std::string& sentence) {
    if (std::find(left_out.begin(), left_out.end(), sentence) == left_out.end()) left_out.push_back(sentence);
}

TriedMethods candidates_for(const CandidateRequest& request) { return Maker(request).all(); }

std::vector<std::string> CommandLines::of(const MethodFigures& figures) const {
    const auto contender = std::find_if(tried.contenders.begin(), tried.contenders.end(),
                                        [&](const Contender& one) { return one.text == figures.method; });
    std::vector<std::string> lines;
    if (contender->method->part == MethodPart::control) return lines;
    const TargetChoice to = target ? *target : find_any_target("c-header");
    const bool exported = target || to.refusal(*contender, sample_rate).empty();
    for (const MadeFile& file : tried.files) {
        // A target that does not hold the whole map is given the map all the same.
        const bool whole_map = exported && contender->method->is_map && file.name == map_file;
        const auto& files = contender->files;
        if (whole_map || std::find(files.begin(), files.end(), file.name) != files.end())
            lines.push_back(file.command);
    }
    lines.push_back(fmt::format("ripplenotch filter {}{} --method {} -o {}", shell_quoted(log), whole,
                                shell_quoted(figures.method), filtered_name(log)));
    if (exported) lines.push_back(to.command(*contender, sample_rate));
    return lines;
}

std::string CommandLines::check(const std::vector<const JudgedMethod*>& methods) const {
    std::string line = fmt::format("ripplenotch compare {}{}{}", shell_quoted(log), judged, gear_words(gear));
    for (const JudgedMethod* method : methods)
        if (method != nullptr) line += " --method " + shell_quoted(method->figures.method);
    return line;
}

}  // namespace ripplenotch
