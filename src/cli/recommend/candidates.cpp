// SPDX-License-Identifier: MIT
#include "cli/recommend/candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>

#include "cli/options/lists.hpp"
#include "cli/options/options.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/map_json.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

namespace {

// " --gear-ratio 100 --orders 1,2"
std::string gear_words(const GearAccount& gear) {
    return " --gear-ratio " + shortest(gear.ratio.value()) + " --orders " + joined(gear.orders, ",");
}

// A name for the filtered log beside this one: "filtered.csv".
std::string filtered_name(const std::string& log) {
    // A name that the filtered log can keep; others hold what is not written or is packed.
    static const std::set<std::string> written = {".csv", ".txt", ".npy", ".mat", ".h5"};
    const std::string ending = std::filesystem::path(log).extension().string();
    return "filtered" + (written.contains(ending) ? ending : ".csv");
}

constexpr std::string_view map_file = "map.json";
constexpr double paper_spacing_hz = 5.0;  ///< of a table's centres, in the lowest order
constexpr int most_bands_tried = 60;
constexpr double highest_share = 0.45;  ///< of the sample rate: the highest centre
constexpr double steady_share = 1.1;    ///< of the median speed: notches that stand still are for one speed

// Wider and narrower notches, longer and shorter memories; what is after the name.
constexpr std::array tracking_settings = {"", ",max-delay=2ms", ",max-delay=10ms", ",q=2.5", ",q=1"};
constexpr std::array oscillator_settings = {"", ",output=minus-ripple", ",memory=0.15", ",memory=2",
                                            ",gain=scheduled"};
constexpr std::array mapped_settings = {"", ",output=minus-ripple"};
constexpr std::array table_qs = {std::pair{"table.json", 0.25}, std::pair{"table_narrow.json", 1.0}};
constexpr std::array low_pass_shares = {0.5, 0.25, 0.1};  ///< of the lowest line at the median speed

double three_digits(double value) { return *parse_number(fmt::format("{:.3g}", value)); }

class Maker {
  public:
    explicit Maker(const CandidateRequest& request) : request_(request), view_(request.train.trace.view()) {
        std::vector<double> speeds;
        const double median = median_moving_speed(view_).value();
        for (const double v : view_.velocity_deg_s)
            if (std::abs(v) > 0.2 * median) speeds.push_back(std::abs(v));
        std::sort(speeds.begin(), speeds.end());
        median_deg_s_ = median;
        if (speeds.empty()) return;
        slowest_deg_s_ = speeds[speeds.size() / 20];
        fastest_deg_s_ = speeds.back();
    }

    TriedMethods all() {
        add("none");
        if (!(fastest_deg_s_ > 0.0)) {
            leave_out("the joint does not move in the part that methods learn from");
            return std::move(made_);
        }
        add_mapped();
        for (const char* const settings : oscillator_settings) add(std::string("oscillator") + settings);
        for (const char* const settings : tracking_settings) add(std::string("tracking") + settings);
        for (const auto& [file, q] : table_qs) add_switching(file, q);
        add_steady();
        return std::move(made_);
    }

  private:
    void leave_out(std::string sentence) { made_.left_out.push_back(std::move(sentence)); }

    void take(Contender contender) {
        const bool control = contender.method->part == MethodPart::control;
        if (!control && request_.target && !request_.target->holds(contender)) {
            const std::string sentence =
                fmt::format("{} does not fit into {}", contender.method->name, request_.target->spec.name);
            if (std::find(made_.left_out.begin(), made_.left_out.end(), sentence) == made_.left_out.end())
                leave_out(sentence);
            return;
        }
        made_.contenders.push_back(std::move(contender));
    }

    void add(const std::string& text, const MapSource& maps = {}) {
        take(choose_method(text, std::nullopt, request_.choice, maps));
    }

    MapFit fitted() {
        MapFit fit = fit_ripple_map({&view_, 1}, request_.gear);
        fit.map.joint = request_.train.trace.joint;
        return fit;
    }

    double line_hz(std::size_t order, double speed_deg_s) const {
        return ripple_frequency(request_.gear.orders[order], request_.gear.ratio, DegPerSec(speed_deg_s))
            .value();
    }

    // What a method reads is what stands in the file, not what was fitted.
    void add_mapped() {
        const MapFit fit = fitted();
        if (fit.map.orders.empty()) {
            leave_out("map and oscillator,map=: " + map_verdict(fit));
            return;
        }
        if (!fit.anchored) {
            leave_out("map: the log has no position that ties the motor's angle");
            return;
        }
        const RippleMap map = map_from_json(map_text(fit, {}), std::string(map_file)).map;
        if (const auto held = request_.target ? request_.target->held(map) : std::nullopt) {
            std::string text = "map";
            for (const auto& [key, value] : map_as_keys(*held)) text += "," + key + "=" + value;
            add(text);
        } else {
            const auto source = [&map](const std::string&) { return map; };
            add(fmt::format("map,map={}", map_file), source);
            for (const char* const settings : mapped_settings)
                add(fmt::format("oscillator,map={}{}", map_file, settings), source);
        }
        made_.files.push_back(
            {std::string(map_file), fmt::format("ripplenotch map {}{} -o {}", request_.train_words,
                                                gear_words(request_.gear), map_file)});
    }

    void add_switching(const std::string& file, double q) {
        const double lowest = request_.gear.orders.front().value() * request_.gear.ratio.value() / 360.0;
        double width = *parse_number(fmt::format("{:.1e}", paper_spacing_hz / lowest));
        const double highest = highest_share * request_.train.recording.update_rate().value() /
                               (request_.gear.orders.back().value() * request_.gear.ratio.value() / 360.0);
        const double top = std::min(fastest_deg_s_, highest);
        while (top / width > most_bands_tried) width = *parse_number(fmt::format("{:.1e}", 2.0 * width));
        const double from = width * std::max(1.0, std::floor(slowest_deg_s_ / width));
        const double bands = std::floor(top / width) - from / width + (top < highest ? 1.0 : 0.0);
        if (!(bands >= 1.0)) {
            leave_out("switching: the speeds are too low for a table of notches");
            return;
        }
        TableSpec spec;
        spec.gear_ratio = request_.gear.ratio;
        spec.orders = request_.gear.orders;
        spec.sample_rate = request_.train.recording.clock.nominal_rate;
        spec.q = q;
        const double to = from + std::round(bands) * width;
        spec.bands = bands_by_spacing({DegPerSec(from), DegPerSec(to)}, DegPerSec(width));
        Contender contender =
            make_contender(parse_spec("switching,table=" + file),
                           std::make_shared<const CandidateTable>(CandidateTable::design(spec)));
        contender.gear = request_.gear;
        contender.files = {file};
        take(std::move(contender));
        made_.files.push_back(
            {file, fmt::format("ripplenotch design{} --sample-rate {}Hz --speed {}:{}:{} --q {} -o {}",
                               gear_words(request_.gear), shortest(spec.sample_rate.value()), shortest(from),
                               shortest(to), shortest(width), shortest(q), file)});
    }

    // Filters of the same coefficients at every speed.
    void add_steady() {
        const double rate = request_.train.recording.update_rate().value();
        const double line = line_hz(0, median_deg_s_);
        if (fastest_deg_s_ <= steady_share * median_deg_s_ &&
            line_hz(request_.gear.orders.size() - 1, fastest_deg_s_) < highest_share * rate) {
            std::string centers;
            for (std::size_t i = 0; i < request_.gear.orders.size(); ++i)
                centers += fmt::format("{}{}Hz", i == 0 ? "" : ":",
                                       shortest(three_digits(line_hz(i, median_deg_s_))));
            for (const double q : {0.25, 1.0})
                add(fmt::format("fixed,centers={},q={}", centers, shortest(q)));
        } else {
            leave_out("fixed: the speed changes, and with it the frequency of the ripple");
        }
        for (const double share : low_pass_shares)
            add(fmt::format("lowpass,cutoff={}Hz,order=1",
                            shortest(three_digits(std::min(share * line, 0.2 * rate)))));
    }

    const CandidateRequest& request_;
    TraceView view_;
    double median_deg_s_ = 0.0, slowest_deg_s_ = 0.0, fastest_deg_s_ = 0.0;
    TriedMethods made_;
};

}  // namespace

bool TargetChoice::holds(const Contender& method) const {
    if (method.method->name == "map") return maps != nullptr;
    if (filters == nullptr) return false;
    if (method.method->needs_table) return filters->switches;
    if (method.method->steady == nullptr) return is_code_target(spec.name) && has_code(method.method->name);
    return !filters->notches_only ||
           std::holds_alternative<std::vector<NotchSpec>>(method.method->steady(method.settings));
}

std::optional<RippleMap> TargetChoice::held(const RippleMap& map) const {
    if (maps == nullptr || map.orders.empty()) return std::nullopt;
    const Settings settings(fmt::format("target {}", spec.name), spec, maps->keys);
    const RippleMap kept = maps->read(maps->write(map, settings, {}).bytes, "the target", map, settings).held;
    if (kept.form.columns() == map.form.columns()) return std::nullopt;
    return kept;
}

std::string TargetChoice::command(const Contender& method, Hertz sample_rate) const {
    const bool is_map = method.method->name == "map";
    const std::string_view endings = is_map ? maps->endings : filters->endings;
    const std::string file = "ripple" + std::string(endings.substr(0, endings.find(' ')));
    const std::string from = is_map || method.method->needs_table
                                 ? (method.files.empty() ? "map.json" : method.files.front())
                                 : fmt::format("--method {} --sample-rate {}Hz", shell_quoted(method.text),
                                               shortest(sample_rate.value()));
    return fmt::format("ripplenotch export {} --to {} -o {}", from, shell_quoted(spec.text()), file);
}

TriedMethods candidates_for(const CandidateRequest& request) { return Maker(request).all(); }

std::vector<std::string> CommandLines::of(const MethodFigures& figures) const {
    const TriedMethods& tried = about_.tried;
    const auto contender = std::find_if(tried.contenders.begin(), tried.contenders.end(),
                                        [&](const Contender& one) { return one.text == figures.method; });
    std::vector<std::string> lines;
    if (contender->method->part == MethodPart::control) return lines;
    for (const MadeFile& file : tried.files) {
        const auto& files = contender->files;
        if (std::find(files.begin(), files.end(), file.name) != files.end()) lines.push_back(file.command);
    }
    lines.push_back(fmt::format("ripplenotch filter {}{} --method {} -o {}", shell_quoted(about_.log),
                                about_.whole, shell_quoted(figures.method), filtered_name(about_.log)));
    if (!about_.target) return lines;
    // A target that does not hold the whole map is given the map all the same.
    if (contender->method->name == "map" && contender->files.empty() && !tried.files.empty())
        lines.insert(lines.begin(), tried.files.front().command);
    lines.push_back(about_.target->command(*contender, about_.sample_rate));
    return lines;
}

std::string CommandLines::check(const std::vector<const JudgedMethod*>& methods) const {
    std::string line = fmt::format("ripplenotch compare {}{}{}", shell_quoted(about_.log), about_.judged,
                                   gear_words(about_.gear));
    for (const JudgedMethod* method : methods)
        if (method != nullptr) line += " --method " + shell_quoted(method->figures.method);
    return line;
}

}  // namespace ripplenotch
