// SPDX-License-Identifier: MIT
// ripplenotch recommend: which method to take for a log, within what it may cost.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/export/target_choice.hpp"
#include "cli/options/joint_runs.hpp"
#include "cli/options/options.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/document/comparison_json.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// A recommendation as people read it.

std::string next_commands(std::string_view head, const std::vector<std::string>& lines) {
    if (lines.empty()) return "";
    return fmt::format("\n{}\n    {}\n", head, fmt::join(lines, "\n    "));
}

std::string orders_of_log(const Recommendation& found) {
    TextRows rows = {{"order", "ripple Nm", "standard error Nm", "detectable Nm", ""}};
    for (const RippleEstimate& one : found.orders) {
        const auto cell = [&](double nm) { return one.searched() ? fmt::format("{:.3f}", nm) : "-"; };
        rows.push_back({order_text(Order(one.order), found.ratio), cell(one.amplitude_nm),
                        cell(one.standard_error_nm), cell(one.detectable_nm),
                        !one.searched() ? one.insufficient
                        : one.present() ? ""
                                        : "not above the noise"});
    }
    return "\n" + text_table(rows, "rrrrl");
}

// What each method leaves, in all, and what it costs.
std::string methods_text(const Recommendation& found) {
    TextRows rows = {
        {"method", "left", "error", "delay", "overshoot", "start", "cost", ""},
        {"", "Nm rms", "Nm rms", "ms", "%", "of ripple", "mult.", found.limits.any() ? "fits" : ""}};
    for (const JudgedMethod& method : found.methods) {
        const MethodFigures& figures = method.figures;
        rows.push_back({short_method(figures), cell_text(figures.ripple_rms_nm, 4),
                        cell_text(figures.error_nm, 4),
                        method.delay ? rounded(1e3 * method.delay->value(), 1) : "not known",
                        cell_text(figures.overshoot_percent, 0), cell_text(figures.start_ratio, 2),
                        rounded(method.multiplications, 0), method.meets() ? "" : "no"});
    }
    return "\n" + text_table(rows, "lr");
}

std::string bulleted(const CommonOptions& common, std::string_view head,
                     const std::vector<std::string>& sentences) {
    if (sentences.empty()) return "";
    std::string text = fmt::format("\n{}\n", head);
    for (const std::string& sentence : sentences) text += "* " + paragraph(common, sentence, 2, 2);
    return text;
}

// Verdict, all methods, commands to paste, what is in the log, and what was assumed.
std::string recommendation_view(const CommonOptions& common, const RecommendationReport& report) {
    const Recommendation& found = report.found;
    std::string text = paragraph(common, recommendation_verdict(found), joint_columns(common));
    if (!found.methods.empty()) text += methods_text(found);
    text += next_commands("To use it:", report.take);
    text += next_commands("The other:", report.runner_up);
    if (!found.orders.empty()) text += orders_of_log(found);
    if (!found.methods.empty()) {
        const std::string parts =
            report.split_s > 0.0
                ? fmt::format("Trained up to {:.6g} s, evaluated from there on", report.split_s)
                : "Evaluated on all of the log";
        text += "\n" +
                paragraph(common,
                          fmt::format("{} in {} windows. Error: output less the torque without ripple and "
                                      "noise. Delay: maximum over the "
                                      "log's speeds, at 0 Hz and within the torque's band, {:.3g} to {:.3g} "
                                      "Hz{}. Start: largest error in "
                                      "the first {:g} s of motion, over that of the raw torque. Cost: "
                                      "multiplications in a sample.",
                                      parts, found.windows, found.band->from.value(), found.band->to.value(),
                                      found.band->stated    ? " as stated"
                                      : found.band->at_rest ? ", which is all that this log resolves"
                                                            : "",
                                      start_seconds));
    }
    if (!report.check.empty()) text += next_commands("To measure it again:", {report.check});
    return text + bulleted(common, "Assumed:", report.assumed) +
           bulleted(common, "Not tried:", report.left_out);
}

constexpr std::size_t most_other_lines = 3;  // by hand: of a sentence

struct RecommendRequest : LogRequest {
    const Options* options = nullptr;
    std::optional<std::string> target;
    Gates limits;
    std::optional<std::string> torque_band;
    std::optional<double> max_start_ratio;
    double train_percent = 60.0;
    bool require_conclusive = false;

    /// The options that read the log, or the part of it between these times.
    [[nodiscard]] std::string log_words(const std::optional<std::string>& from,
                                        const std::optional<std::string>& to) const {
        return options->log_words(from, to, joint);
    }
};

/// The log, and its parts as --to and --from give them.
struct Parts {
    Log whole, train, judge;
    ReadOptions train_options, judge_options;
};

void check_recommend(const RecommendRequest& request) {
    if (request.path == "-")
        raise<UsageError>(
            "recommend reads the log three times; standard input can be read once: name a file");
    if (!(request.train_percent >= 10.0 && request.train_percent <= 90.0))
        raise<UsageError>("--train {} % is not from 10 to 90", shortest(request.train_percent));
    if (request.limits.max_delay && !(request.limits.max_delay->value() >= 0.0))
        raise<UsageError>("--max-delay is below 0");
}

// "0:10Hz"
std::optional<TorqueBand> stated_band(const std::optional<std::string>& text) {
    if (!text) return std::nullopt;
    const auto colon = text->find(':');
    if (colon == std::string::npos)
        raise<UsageError>("--torque-band: '{}' is not FROM:TO, for example 0:10Hz", *text);
    const auto hertz = [](const std::string& part) {
        return Hertz(parse_quantity(part, Dimension::frequency, "--torque-band"));
    };
    const TorqueBand band{hertz(text->substr(0, colon)), hertz(text->substr(colon + 1)), true, false,
                          hertz(text->substr(colon + 1))};
    if (!(band.from.value() >= 0.0 && band.from < band.to))
        raise<UsageError>("--torque-band: '{}' does not rise from 0 Hz or more", *text);
    return band;
}

// A time that people can read, on the log's own axis.
double split_at(const Log& log, double percent) {
    const double zero_s = log.recording.outside ? log.recording.outside->zero_s : 0.0;
    const double from_s = log.trace.time_s.front() + zero_s, to_s = log.trace.time_s.back() + zero_s;
    const double at_s = from_s + 0.01 * percent * (to_s - from_s);
    const int digits = static_cast<int>(std::floor(portable::log10(std::max(to_s - from_s, 1e-6)))) - 2;
    return *parse_number(fmt::format("{:.{}f}", at_s, std::max(-digits, 0)));
}

std::string split_words(double split_s) { return shortest(split_s) + "s"; }

Parts read_parts(const RecommendRequest& request, const std::optional<GearAccount>& gear, double& split_s,
                 Provenance& provenance) {
    Parts parts;
    parts.whole = read_log_in_part(request.path, read_options(request.log, gear));
    take_log(request.common, request.path, parts.whole, provenance);
    split_s = split_at(parts.whole, request.train_percent);
    parts.train_options = parts.judge_options = read_options(request.log, gear);
    parts.train_options.range.to = parts.judge_options.range.from =
        parse_time_point(split_words(split_s), "--to");
    parts.train = read_log_in_part(request.path, parts.train_options);
    parts.judge = read_log_in_part(request.path, parts.judge_options);
    return parts;
}

// Why a log without a line that turns with the joint has none, and what to record.
std::string reason_without_lines(const Identification& found) {
    // A clause of its own says what settles it.
    if (!found.doubts.empty()) {
        std::string because = found.doubts.front().because;
        for (std::size_t at = because.find("; "); at != std::string::npos; at = because.find("; ", at + 1))
            because[at] = '.';
        return because;
    }
    switch (found.finding) {
        case RippleFinding::nothing:
            return fmt::format("no line above {:.2g} Nm from {:.4g} to {:.4g} per turn of the joint",
                               found.searched->detectable_nm, found.searched->lowest_order,
                               found.searched->highest_order);
        case RippleFinding::too_noisy:
            return fmt::format(
                "a line of {:.2g} Nm would be missed in this noise; record more turns of the joint",
                found.searched->detectable_nm);
        case RippleFinding::too_little:
            return "the joint is at rest or moves too little; record motion in one direction at several "
                   "speeds";
        default:
            return "no line of a drive turns with the joint; --orders states one, for example 200/turn";
    }
}

struct FoundLines {
    GearOptions gear;
    bool at_one_speed = false;
};

std::optional<FoundLines> lines_of(const Identification& identified) {
    const GearStatement lines = JointFile{"", "", identified}.facts();
    if (lines.orders.empty()) return std::nullopt;
    FoundLines found{{}, !lines.ratio && identified.finding == RippleFinding::one_speed};
    if (lines.ratio) found.gear.ratio = *parse_number(fmt::format("{:.6g}", lines.ratio->value()));
    found.gear.orders = lines.orders;
    return found;
}

// The lines of the whole log, as identify reports them, or else of its first part; empty, with the reason,
// where there are none.
std::optional<FoundLines> found_gear_options(const Parts& parts, Recommendation& found) {
    const Log& log = parts.whole;
    if (log.trace.size() < fewest_identify_samples) {
        found.why = fmt::format("{} rows are too few to look for ripple in, and {} are needed",
                                log.trace.size(), fewest_identify_samples);
        return std::nullopt;
    }
    const Identification identified = identify_readings({&log, 1}, {});
    if (auto lines = lines_of(identified)) return lines;
    if (parts.train.trace.size() >= fewest_identify_samples)
        if (auto lines = lines_of(identify_readings({&parts.train, 1}, {}))) return lines;
    found.why = reason_without_lines(identified);
    if (identified.conclusive && identified.finding == RippleFinding::nothing)
        found.finding = RecommendationFinding::no_ripple;
    return std::nullopt;
}

std::vector<RippleEstimate> ripple_of(const Trace& trace, const GearAccount& gear) {
    const TraceView view = trace.view();
    return estimate_ripple({&view, 1}, gear.ratio, gear.orders);
}

// A reading under which something turns with the motor is confirmed by that, unless another one has it, too.
void doubt_readings(const Parts& parts, const GearAccount& gear, Recommendation& found) {
    const auto shows = [&](const OtherReading& reading) {
        const Trace trace = read_otherwise(parts.whole.trace, reading);
        const auto orders = ripple_of(trace, gear);
        return std::any_of(orders.begin(), orders.end(), std::mem_fn(&RippleEstimate::present));
    };
    const std::string doubt = reading_doubt({&parts.whole, 1}, [&](const OtherReading& reading) {
        return !reading.changes_side && shows(reading);
    });
    if (doubt.empty()) return;
    found.finding = RecommendationFinding::cannot_tell;
    found.why = doubt;
    found.methods.clear();
    found.orders.clear();  // of the one reading alone
}

// Where the orders that were stated are not there, and others are, nothing is settled.
void name_other_lines(const Log& log, const GearAccount& gear, Recommendation& found) {
    if (found.finding != RecommendationFinding::no_ripple) return;
    IdentifyOptions options;
    if (gear.has_ratio()) options.hint = gear.ratio;
    const double resolution = ripple_resolution_orders * gear.orders.front().value();
    std::vector<std::string> others;
    for (const Line& line : identify_readings({&log, 1}, options).lines) {
        if (line.kind != LineKind::order || !line.order_output) continue;
        const double order = *line.order_output / gear.ratio.value();
        const bool asked = std::any_of(gear.orders.begin(), gear.orders.end(),
                                       [&](Order one) { return std::abs(one.value() - order) < resolution; });
        if (!asked && others.size() < most_other_lines)
            others.push_back(fmt::format("{:.2g} Nm at {}", line.amplitude_nm,
                                         order_in_words(Order(to_digits(order, 4)), gear.ratio)));
    }
    if (others.empty()) return;
    found.finding = RecommendationFinding::cannot_tell;
    found.why +=
        fmt::format(". But identify finds {}: --orders states which to remove", fmt::join(others, ", "));
}

// identify sums over whole sweeps and finds lines that are too faint in the windows by which filters are
// judged.
void say_too_faint(const GearAccount& gear, Recommendation& found) {
    if (found.finding != RecommendationFinding::no_ripple) return;
    double judged_nm = 0.0;
    for (const RippleEstimate& one : found.orders) judged_nm = std::max(judged_nm, one.detectable_nm);
    found.why = fmt::format("identify finds {}, fainter than the {:.2g} Nm from which filters can be judged",
                            orders_text(gear.orders, gear.ratio, ", "), judged_nm);
}

std::vector<std::string> assumptions(const RecommendRequest& request, const Parts& parts,
                                     const GearAccount& gear, bool stated) {
    std::vector<std::string> all;
    for (const Assumption& one : parts.whole.layout.assumptions)
        all.push_back(fmt::format("{}: {} ({})", one.about, one.assumed, one.settle_with));
    all.push_back(fmt::format("{}, {}",
                              gear.has_ratio() ? fmt::format("gear ratio {:.6g}", gear.ratio.value())
                                               : orders_text(gear.orders, gear.ratio, ", ") + " of the joint",
                              stated             ? "as stated: " + gear.source
                              : gear.has_ratio() ? "as identify finds it; --gear-ratio settles it"
                                                 : "as identify finds them; no filter needs the ratio"));
    if (request.gear.joint_file)
        all.push_back(
            fmt::format("{} was not made from the part of the log that is judged", *request.gear.joint_file));
    all.emplace_back("the joint will move, and bear loads, as it does in the log's last part");
    return all;
}

constexpr std::string_view map_file = "map.json";

// " --gear-ratio 100 --orders 1,2", " --orders 200/turn"
std::string gear_words(const GearAccount& gear) {
    const std::string ratio = gear.has_ratio() ? " --gear-ratio " + shortest(gear.ratio.value()) : "";
    return ratio + " --orders " + orders_text(gear.orders, gear.ratio, ",");
}

// A name for the filtered log next to this one: "filtered.csv".
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

/// The settings that each method holds worth trying, of all methods, with the files that they need made in
/// memory as the commands would make them. The same for every limit, so that looser limits never give a worse
/// answer.
class Candidates {
  public:
    /// All are borrowed. `split`: the end of the part that methods learn from, as --to has it.
    Candidates(const RecommendRequest& request, const Parts& parts, const GearChoice& choice,
               const GearAccount& gear, const std::optional<TargetChoice>& target, const std::string& split)
        : request_(request),
          parts_(parts),
          choice_(choice),
          gear_(gear),
          target_(target),
          train_words_(shell_quoted(request.path) + request.log_words({}, split)),
          rate_(parts.whole.recording.clock.nominal_rate) {
        const TraceView train = parts.train.trace.view();
        const auto extent = moving_speeds(train);
        if (extent) fit_map(train);
        for (const Method* method : methods()) {
            if (method->trials == nullptr)
                add(std::string(method->name));
            else if (extent)
                try_settings(*method, *extent);
        }
        if (!extent) leave_out("the joint does not move in the part that methods learn from");
    }

    /// What was not tried, and why, one sentence each.
    [[nodiscard]] const std::vector<std::string>& left_out() const { return left_out_; }

    /// What cannot be designed at the log's rate, and a map of part of the speeds that the log moves at, is
    /// left out. A log whose last part is too short is judged in all, by the methods that learn nothing of
    /// it: `on_all` says so.
    Recommendation judged(const RecommendationLimits& limits, const std::optional<TorqueBand>& band,
                          bool& on_all) {
        std::erase_if(contenders_, [&](const Contender& one) {
            const std::string why = one.refusal(rate_);
            if (!why.empty()) leave_out(why);
            return !why.empty();
        });
        leave_out_far_maps();
        const std::vector<RippleEstimate> ripple = ripple_of(parts_.whole.trace, gear_);
        Recommendation found = recommend(contenders_, compared(parts_.judge), gear_, limits, ripple, band);
        on_all = found.finding == RecommendationFinding::cannot_tell &&
                 std::any_of(ripple.begin(), ripple.end(), std::mem_fn(&RippleEstimate::present));
        if (!on_all) return found;
        leave_out_maps("a ripple map: the log is too short to make it of one part and judge it on another");
        return recommend(contenders_, compared(parts_.whole), gear_, limits, ripple, band);
    }

    /// The command lines that make use of a method, one after the other; its export comes last: as C code
    /// where there is some, if no target is asked for.
    [[nodiscard]] std::vector<std::string> commands(const MethodFigures& figures) const {
        const auto contender = std::find_if(contenders_.begin(), contenders_.end(),
                                            [&](const Contender& one) { return one.text == figures.method; });
        std::vector<std::string> lines;
        if (contender->method->part == MethodPart::control) return lines;
        const TargetChoice to = target_ ? *target_ : find_any_target("c-header");
        const bool exported = target_ || to.refusal(*contender, rate_).empty();
        for (const auto& [file, command] : made_) {
            // A target that does not hold the whole map is given the map all the same.
            const bool whole_map = exported && contender->method->is_map && file == map_file;
            const auto& files = contender->files;
            if (whole_map || std::find(files.begin(), files.end(), file) != files.end())
                lines.push_back(command);
        }
        lines.push_back(fmt::format("ripplenotch filter {}{} --method {} -o {}", shell_quoted(request_.path),
                                    request_.log_words({}, {}), shell_quoted(figures.method),
                                    filtered_name(request_.path)));
        if (exported) lines.push_back(to.command(*contender, rate_));
        return lines;
    }

    /// The command line that measures methods again as they were measured here; null ones are left out.
    /// `part`: the options that read the part that was judged.
    [[nodiscard]] std::string check(const std::string& part,
                                    const std::vector<const JudgedMethod*>& judged) const {
        std::string line =
            fmt::format("ripplenotch compare {}{}{}", shell_quoted(request_.path), part, gear_words(gear_));
        for (const JudgedMethod* method : judged)
            if (method != nullptr) line += " --method " + shell_quoted(method->figures.method);
        return line;
    }

  private:
    void leave_out(const std::string& sentence) {
        if (std::find(left_out_.begin(), left_out_.end(), sentence) == left_out_.end())
            left_out_.push_back(sentence);
    }

    void try_settings(const Method& method, const MovingSpeeds& speeds) {
        const Trials trials =
            method.trials({gear_, rate_, parts_.train.recording.update_rate(), speeds.slowest, speeds.median,
                           speeds.fastest, map_ ? std::string(map_file) : ""});
        if (!trials.none_because.empty()) leave_out(fmt::format("{}: {}", method.name, trials.none_because));
        for (const Trial& trial : trials.all) {
            const std::string text = std::string(method.name) + trial.settings;
            if (trial.table)
                add_table(text, *trial.table);
            else if (const auto held = method.is_map && target_ ? target_->held(*map_) : std::nullopt)
                add_held(std::string(method.name), *held);
            else
                add(text);
        }
    }

    void take(Contender contender) {
        const std::string why = contender.method->part != MethodPart::control && target_
                                    ? target_->refusal(contender, rate_)
                                    : "";
        if (why.empty())
            contenders_.push_back(std::move(contender));
        else
            leave_out(
                fmt::format("{} does not fit into {}: {}", contender.method->name, target_->spec.name, why));
    }

    void add(const std::string& text) {
        take(choose_method(text, std::nullopt, choice_, [this](const std::string&) { return *map_; }));
    }

    void add_held(std::string text, const RippleMap& held) {
        for (const auto& [key, value] : map_as_keys(held)) text += "," + key + "=" + value;
        add(text);
    }

    // What a method reads is what stands in the file, not what was fitted.
    void fit_map(const TraceView& train) {
        MapFit fit = fit_ripple_map({&train, 1}, gear_);
        fit.map.joint = parts_.train.trace.joint;
        if (fit.map.orders.empty() || !fit.anchored) {
            leave_out("a ripple map: " +
                      (fit.map.orders.empty()
                           ? map_verdict(fit)
                           : std::string("the log has no position that ties the motor's angle")));
            return;
        }
        map_ = map_from_json(map_text(fit, {}), std::string(map_file)).map;
        made_.emplace_back(
            map_file, fmt::format("ripplenotch map {}{} -o {}", train_words_, gear_words(gear_), map_file));
    }

    void add_table(const std::string& text, const TableSpec& spec) {
        Contender contender = make_contender(
            parse_spec(text), std::make_shared<const CandidateTable>(CandidateTable::design(spec)));
        const std::string file = contender.settings.text("table");
        contender.gear = gear_;
        contender.files = {file};
        take(std::move(contender));
        const auto& [slowest_from, slowest_to] = spec.bands.front();
        made_.emplace_back(
            file, fmt::format("ripplenotch design{} --sample-rate {}Hz --speed {}:{}:{} --q {} -o {}",
                              gear_words(gear_), shortest(spec.sample_rate.value()),
                              shortest(slowest_from.value()), shortest(spec.bands.back().second.value()),
                              shortest((slowest_to - slowest_from).value()), shortest(spec.q), file));
    }

    [[nodiscard]] ComparedLog compared(const Log& on) const {
        ComparedLog log{on.trace.view()};
        log.trace.sample_rate = rate_;
        return log;
    }
    // The command that is printed filters all of the log.
    void leave_out_far_maps() {
        const auto mapped = std::find_if(contenders_.begin(), contenders_.end(),
                                         [](const Contender& one) { return one.map != nullptr; });
        if (mapped == contenders_.end()) return;
        try {
            static_cast<void>(output_on_log(*mapped, compared(parts_.whole)));
        } catch (const DataError& error) {
            leave_out_maps(error.what());
        }
    }
    void leave_out_maps(const std::string& why) {
        const auto has_map = [](const Contender& one) { return one.map != nullptr || one.method->is_map; };
        if (std::erase_if(contenders_, has_map) > 0) leave_out(why);
    }

    const RecommendRequest& request_;
    const Parts& parts_;
    const GearChoice& choice_;
    const GearAccount& gear_;
    const std::optional<TargetChoice>& target_;
    std::string train_words_;  ///< the log's name, with the options that read the part that is learnt from
    Hertz rate_;               ///< of the whole log, which the filters are designed for
    std::optional<RippleMap> map_;
    std::vector<Contender> contenders_;
    std::vector<std::pair<std::string, std::string>> made_;  ///< files, each with the command that makes it
    std::vector<std::string> left_out_;
};

// Empty where the log has to show the lines: orders by the motor name none without a ratio.
std::optional<GearAccount> stated_gear(const GearOptions& options, const GearChoice& choice) {
    const bool by_motor =
        std::any_of(options.orders.begin(), options.orders.end(), std::not_fn(&StatedOrder::per_turn));
    if (by_motor && !options.ratio && !options.joint_file) return std::nullopt;
    return choice.of();
}

RecommendationReport report_of(const RecommendRequest& request, Provenance& provenance) {
    RecommendationReport report;
    report.target = request.target.value_or("");
    const auto target = request.target ? std::optional(find_any_target(*request.target)) : std::nullopt;
    const auto band = stated_band(request.torque_band);
    const GearChoice stated(request.gear);
    const std::optional<GearAccount> stated_lines = stated_gear(request.gear, stated);
    Parts parts = read_parts(request, stated_lines, report.split_s, provenance);
    if (stated.joint()) provenance.inputs.push_back(input_record(stated.joint()->path));
    GearOptions gear_options = request.gear;
    report.found.limits = {request.limits.max_delay, request.limits.min_attenuation_db,
                           request.max_start_ratio, !request.gear.orders.empty()};
    bool at_one_speed = false;
    if (!stated_lines) {
        const auto found = found_gear_options(parts, report.found);
        report.conclusive = report.found.finding == RecommendationFinding::no_ripple;
        if (!found) return report;
        gear_options = found->gear;
        at_one_speed = found->at_one_speed;
        if (!request.gear.orders.empty()) gear_options.orders = request.gear.orders;
    }
    const GearChoice choice(gear_options);
    report.gear = choice.of();
    if (!stated_lines) report.gear->source = "identify";
    say(request.common, gear_in_words(*report.gear));
    const std::string split = split_words(report.split_s);
    Candidates candidates(request, parts, choice, *report.gear, target, split);
    bool on_all = false;
    report.found = candidates.judged(report.found.limits, band, on_all);
    const JudgedMethod* const first = report.found.taken();
    if (report.found.finding == RecommendationFinding::out_of_reach && target &&
        part_of(first->figures) == MethodPart::control)
        report.found.why = fmt::format("{} can hold none of the methods", target->spec.text());
    if (stated_lines)
        name_other_lines(parts.whole, *report.gear, report.found);
    else if (request.gear.orders.empty())
        say_too_faint(*report.gear, report.found);
    doubt_readings(parts, *report.gear, report.found);
    report.assumed = assumptions(request, parts, *report.gear, stated_lines.has_value());
    if (at_one_speed)
        report.assumed.emplace_back(
            "the lines turn with the joint: at one speed they could as well be fixed tones; a log at another "
            "speed "
            "settles it");
    report.conclusive = report.found.finding != RecommendationFinding::cannot_tell;
    // Where nothing can be told, nothing was tried: no list of what was not.
    if (report.conclusive) report.left_out = candidates.left_out();
    const std::string against = stated_lines ? against_gear({&parts.whole, 1}, *report.gear) : "";
    if (!against.empty()) {
        warn(request.common, against);
        report.assumed.insert(report.assumed.begin(), against);
        report.conclusive = false;
    }
    if (report.found.methods.empty()) return report;
    if (on_all) {
        report.split_s = 0.0;
        report.assumed.emplace_back(
            "the log is too short for a part of its own to judge by: all of it judges");
    }
    const JudgedMethod* const next = report.found.runner_up();
    report.take = candidates.commands(first->figures);
    if (next != nullptr) report.runner_up = candidates.commands(next->figures);
    report.check =
        candidates.check(on_all ? request.log_words({}, {}) : request.log_words(split, {}), {first, next});
    return report;
}

Answer recommend_for_joint(const RecommendRequest& request, const std::string& command_line) {
    Provenance provenance{{}, command_line};
    const RecommendationReport report = report_of(request, provenance);
    const std::string unit = provenance.recordings.front().torque_unit;
    Answer result{in_torque_unit(recommendation_view(request.common, report), unit)};
    result.document = [report, provenance, unit] {
        return in_torque_unit(recommendation_text(report, provenance), unit);
    };
    if (report.found.finding == RecommendationFinding::out_of_reach)
        result.code = ExitCode::limit_violated;
    else if (request.require_conclusive && !report.conclusive)
        result.code = ExitCode::inconclusive;
    return result;
}

Answer run_recommend(const RecommendRequest& request, const std::string& command_line) {
    check_recommend(request);
    return ask_joints(request, "recommendations",
                      [&](const RecommendRequest& one) { return recommend_for_joint(one, command_line); });
}

std::function<Answer()> attach_recommend(Options& options) {
    const auto request = std::make_shared<RecommendRequest>();
    options.argument("LOG", request->path, true, "a log of the joint, as it moves at work");
    attach_gear(options, request->gear);
    options.duration("--max-delay", request->limits.max_delay,
                     "longest delay at 0 Hz and within the torque's band at any speed of the log, e.g. 10ms");
    options.number("--min-attenuation", request->limits.min_attenuation_db, Dimension::decibel,
                   "of every order that shows in the log, e.g. 20dB");
    options.number(
        "--max-start-error", request->max_start_ratio, Dimension::none,
        "largest error in the first two seconds of motion, in times the unfiltered torque's, e.g. 1.5");
    options.text("--torque-band", request->torque_band, "FROM:TO",
                 "frequencies of the torque that have to pass, e.g. 0:10Hz; left out: found in the log");
    options.text("--target", request->target, "TARGET[,KEY=VALUE...]",
                 "only methods that this export target holds; see docs/export");
    options.number("--train", request->train_percent, Dimension::none,
                   "per cent of the log that methods learn from; they are evaluated on the rest");
    attach_conclusive(options, request->require_conclusive);
    attach_log(options, request->log);
    request->options = &options;
    attach_common(options, request->common, {"a recommendation", ".txt .json", true});
    return [request, &options] { return run_recommend(*request, options.command_line()); };
}

}  // namespace

const Command commands::recommend = {
    .name = "recommend",
    .summary = "which method to use for a log, and why, as commands to paste",
    .description =
        "Runs the methods on the log itself: their parameters are estimated on its first part, and they are "
        "evaluated on\nthe rest, as compare measures. Reports the method with the smallest output error "
        "within\nthe limits, and the next best.\nExample: ripplenotch recommend log.csv --gear-ratio 100 "
        "--orders 1,2 --max-delay 10ms",
    .attach = attach_recommend,
};

}  // namespace ripplenotch
