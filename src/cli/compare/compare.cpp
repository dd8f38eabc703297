// SPDX-License-Identifier: MIT
// ripplenotch compare: several methods side by side on a log, a step or a ramp.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/joint_runs.hpp"
#include "cli/options/options.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/design/guarantee.hpp"
#include "ripplenotch/document/comparison_json.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// The methods of a comparison and the ripple it looks at, from what was typed and the files it names.
struct Field {
    std::vector<Contender> contenders;            ///< the control first, unless it was typed elsewhere
    std::shared_ptr<const CandidateTable> table;  ///< of the first method that needs one
    /// Whose ripple all of them are measured by: that of the options and the joint file, else of the first
    /// method that follows the gear, else of the first table. Empty when nothing says where the ripple is.
    std::optional<GearAccount> gear;
};

// What the methods may cost a control loop.
struct CostRequest {
    std::optional<Hertz> crossover;
    Gates gates;
};

// A comparison as people read it.

std::string ledger_place(const LedgerEntry& entry) {
    if (entry.band > 0)
        return fmt::format("{}: {:.5g}-{:.5g}", entry.band, entry.from.value(), entry.to.value());
    return entry.to.value() > 0.0 ? fmt::format("{:g}", entry.from.value()) : "any";
}

std::vector<std::string> ledger_row(const LedgerEntry& entry, bool crossover) {
    std::vector<std::string> cells = {ledger_place(entry), rounded(1e3 * entry.dc_delay.value(), 1),
                                      cell_text(entry.ramp_delay, 1, 1e3)};
    for (std::size_t i = 0; i < settle_bands_percent.size(); ++i)
        cells.push_back(entry.step ? rounded(1e3 * entry.step->settle[i].value(), 0) : "-");
    cells.push_back(entry.step ? rounded(entry.step->overshoot_percent, 1) : "-");
    if (crossover) {
        cells.push_back(cell_text(entry.phase_lag_deg, 1));
        cells.push_back(cell_text(entry.crossover_db, 1));
    }
    return cells;
}

std::string band_name(int band) { return band > 0 ? std::to_string(band) : "none"; }

// Errors are there where the true torque is known.
std::string switches_text(const MethodFigures& figures) {
    if (figures.switch_ledger.empty()) return "";
    const bool truth = figures.switch_ledger.front().peak_error_nm.has_value();
    TextRows rows = {{"change", "from", "to", "speed", "jump"}, {"at s", "band", "band", "deg/s", "Nm"}};
    if (truth) {
        rows[0].insert(rows[0].end(), {"error, Nm", "", "peak after", "settles, ms"});
        rows[1].insert(rows[1].end(), {"before", "peak", "ms"});
        for (const double percent : settle_bands_percent) rows[1].push_back(fmt::format("to {} %", percent));
    }
    for (const SwitchEntry& entry : figures.switch_ledger) {
        rows.push_back({rounded(entry.time.value(), 3), band_name(entry.change.from_band),
                        band_name(entry.change.to_band), rounded(entry.change.speed_deg_s, 1),
                        rounded(entry.change.jump_nm, 3)});
        if (!truth) continue;
        auto& cells = rows.back();
        cells.push_back(cell_text(entry.error_before_nm, 3));
        cells.push_back(rounded(entry.peak_error_nm.value_or(0.0), 3));
        cells.push_back(cell_text(entry.peak_after, 0, 1e3));
        for (const auto& settle : entry.settle) cells.push_back(cell_text(settle, 0, 1e3));
    }
    return "\n" + text_table(rows, "r");
}

// One table a method, a row for every band or speed, and for each method that has a limit the speed from
// which it keeps it. Empty when no ledger was asked for.
std::string ledger_text(const Comparison& comparison) {
    std::string text;
    for (const MethodFigures& figures : comparison.methods) {
        if (figures.within_from) {
            text += figures.within_from->value() > 0.0
                        ? fmt::format("{}: within the delay limit from {:.3g} deg/s on.\n", figures.method,
                                      figures.within_from->value())
                        : fmt::format("{}: within the delay limit at every speed.\n", figures.method);
        }
        if (figures.ledger.empty()) continue;
        TextRows rows = {{"speed", "DC delay", "ramp delay", "settles, ms"}, {"deg/s", "ms", "ms"}};
        for (std::size_t i = 0; i < settle_bands_percent.size(); ++i) {
            if (i > 0) rows[0].push_back("");
            rows[1].push_back(fmt::format("to {} %", settle_bands_percent[i]));
        }
        rows[0].push_back("overshoot");
        rows[1].push_back("%");
        if (comparison.crossover) {
            rows[0].push_back(fmt::format("lag at {:g} Hz", comparison.crossover->value()));
            rows[0].push_back("gain");
            rows[1].insert(rows[1].end(), {"deg", "dB"});
        }
        for (const LedgerEntry& entry : figures.ledger)
            rows.push_back(ledger_row(entry, comparison.crossover.has_value()));
        text += fmt::format("\n{}\n", figures.method) + text_table(rows, "r") + switches_text(figures);
    }
    if (comparison.no_notch_below)
        text += "\n" + slowest_sentence(*comparison.max_delay, *comparison.no_notch_below) + "\n";
    return text;
}

constexpr std::size_t page_width = 100;  // of tables; chosen, not derived

struct ViewColumn {
    std::string title, unit;
    std::function<std::string(const MethodFigures&)> cell;  ///< "-": not measured
    bool with_next = false;  ///< stands beside the next one: they share a title
};

ViewColumn column_of(std::string title, std::string unit, std::optional<double> MethodFigures::*value,
                     int decimals, bool with_next = false) {
    return {std::move(title), std::move(unit),
            [value, decimals](const MethodFigures& figures) {
                const bool large = figures.*value && std::abs(*(figures.*value)) >= 1000.0;
                return cell_text(figures.*value, large ? 0 : decimals);
            },
            with_next};
}

std::string attenuation(const MethodFigures& figures, std::size_t line) {
    if (line >= figures.attenuation.size() || !figures.attenuation[line].db) return "-";
    const double db = *figures.attenuation[line].db;
    return db >= most_attenuation_db ? fmt::format(">{:.0f}", most_attenuation_db) : rounded(db, 1);
}

// What a method costs.
std::vector<ViewColumn> cost_columns(const Comparison& comparison) {
    std::vector<ViewColumn> columns;
    for (std::size_t b = 0; b < settle_bands_percent.size(); ++b) {
        columns.push_back(
            {b == 0 ? "settles, ms" : "", fmt::format("to {} %", settle_bands_percent[b]),
             [b](const MethodFigures& f) { return f.settle_ms ? rounded((*f.settle_ms)[b], 0) : "-"; },
             b + 1 < settle_bands_percent.size()});
    }
    columns.push_back(column_of("overshoot", "%", &MethodFigures::overshoot_percent, 1));
    columns.push_back(column_of("of a ramp", "Nm", &MethodFigures::ramp_overshoot_nm, 2));
    columns.push_back(column_of("ramp delay", "ms", &MethodFigures::ramp_delay_ms, 1, true));
    columns.push_back(column_of("DC delay", "ms", &MethodFigures::dc_delay_ms, 1));
    if (!comparison.crossover) return columns;
    columns.push_back(column_of(fmt::format("lag at {:g} Hz", comparison.crossover->value()), "deg",
                                &MethodFigures::phase_lag_deg, 1, true));
    columns.push_back(column_of("", "dB", &MethodFigures::crossover_db, 1));
    return columns;
}

// What it leaves.
std::vector<ViewColumn> result_columns(const Comparison& comparison) {
    std::vector<ViewColumn> columns;
    for (std::size_t i = 0; comparison.lines && i < comparison.lines->orders.size(); ++i)
        columns.push_back({order_in_words(comparison.lines->orders[i], comparison.lines->ratio), "dB",
                           [i](const MethodFigures& f) { return attenuation(f, i); }});
    columns.push_back(column_of("ripple", "Nm rms", &MethodFigures::ripple_rms_nm, 4));
    columns.push_back(column_of("torque moved", "Nm rms", &MethodFigures::moved_nm, 4));
    columns.push_back(column_of("added", "Nm rms", &MethodFigures::added_nm, 4));
    columns.push_back(column_of("error", "Nm rms", &MethodFigures::error_nm, 4));
    columns.push_back(column_of("start", "of raw", &MethodFigures::start_ratio, 1));
    columns.push_back(column_of("residual", "Nm rms", &MethodFigures::residual_rms_nm, 4, true));
    columns.push_back(column_of("", "Nm p-p", &MethodFigures::residual_peak_to_peak_nm, 3));
    columns.push_back(column_of("true error", "Nm rms", &MethodFigures::error_rms_nm, 4));
    columns.push_back({"switches", "",
                       [](const MethodFigures& f) { return f.switches ? std::to_string(*f.switches) : "-"; },
                       true});
    columns.push_back(column_of("largest", "jump, Nm", &MethodFigures::largest_jump_nm, 3));
    return columns;
}

// The names of the methods below two lines of head.
TextRows names_of(const Comparison& comparison) {
    TextRows rows = {{"method"}, {""}};
    for (const MethodFigures& figures : comparison.methods) rows.push_back({figures.method});
    return rows;
}

// The same with further columns; those that no method has a figure for are left out.
TextRows with_columns(TextRows rows, const Comparison& comparison, std::span<const ViewColumn> columns) {
    for (const ViewColumn& column : columns) {
        std::vector<std::string> cells;
        for (const MethodFigures& figures : comparison.methods) cells.push_back(column.cell(figures));
        if (std::all_of(cells.begin(), cells.end(), [](const std::string& one) { return one == "-"; }))
            continue;
        rows[0].push_back(column.title);
        rows[1].push_back(column.unit);
        for (std::size_t i = 0; i < cells.size(); ++i) rows[i + 2].push_back(std::move(cells[i]));
    }
    return rows;
}

bool fits(std::string_view text) {
    const auto lines = split(text, '\n');
    return std::all_of(lines.begin(), lines.end(),
                       [](std::string_view line) { return line.size() <= page_width; });
}

// Tables to stand one below the other, each as wide as the page at most.
std::vector<std::string> tables_of(const Comparison& comparison, std::span<const ViewColumn> columns) {
    std::vector<std::string> tables;
    for (std::size_t at = 0; at < columns.size();) {
        TextRows rows = names_of(comparison);
        do {
            std::size_t end = at + 1;
            while (columns[end - 1].with_next) ++end;
            TextRows wider = with_columns(rows, comparison, columns.subspan(at, end - at));
            if (rows[0].size() > 1 && !fits(text_table(wider, "lr"))) break;
            rows = std::move(wider);
            at = end;
        } while (at < columns.size());
        if (rows[0].size() > 1) tables.push_back(text_table(rows, "lr"));
    }
    return tables;
}

// All in one table where it fits on the page; else what the methods cost above what they leave, unless that
// takes more tables than need be.
std::string rows_of(const Comparison& comparison) {
    const std::vector<ViewColumn> costs = cost_columns(comparison), results = result_columns(comparison);
    std::vector<ViewColumn> all = costs;
    all.insert(all.end(), results.begin(), results.end());
    std::vector<std::string> tables = tables_of(comparison, all);
    if (tables.empty()) return text_table(names_of(comparison), "l");
    if (tables.size() > 1) {
        std::vector<std::string> apart = tables_of(comparison, costs);
        for (std::string& table : tables_of(comparison, results)) apart.push_back(std::move(table));
        if (apart.size() <= tables.size()) tables = std::move(apart);
    }
    return fmt::format("{}", fmt::join(tables, "\n"));
}

// The band that switching methods have in force, said once where it is the same for all of them.
std::string notes_in_force(const CommonOptions& common, const Comparison& comparison) {
    std::vector<const MethodFigures*> switching;
    for (const MethodFigures& figures : comparison.methods) {
        if (figures.switches && !figures.note.empty()) switching.push_back(&figures);
    }
    const bool alike = std::all_of(switching.begin(), switching.end(), [&](const MethodFigures* figures) {
        return figures->note == switching.front()->note;
    });
    if (switching.size() > 1 && alike)
        return paragraph(common, fmt::format("All {} switching methods at this speed: {}.", switching.size(),
                                             switching.front()->note));
    std::string text;
    for (const MethodFigures* figures : switching)
        text += paragraph(common, fmt::format("{} at this speed: {}.", figures->method, figures->note));
    return text;
}

std::string conditions(const CommonOptions& common, const Comparison& comparison) {
    std::string text, on;
    if (comparison.on_log) {
        on = fmt::format("Log: {} rows at {:.6g} Hz.", comparison.rows, comparison.sample_rate.value());
        if (comparison.windows > 0) {
            on += fmt::format(
                " Orders, ripple, how far the torque's trend is moved, and residual (torque minus its trend) "
                "are measured in {} window{}, "
                "{:.0f} % of the log.",
                comparison.windows, comparison.windows == 1 ? "" : "s", 100.0 * comparison.measured_share);
        }
        text = paragraph(common, on);
        on = comparison.fastest > DegPerSec(0.0)
                 ? fmt::format("Settling and delays: at {:.4g} deg/s, on", comparison.speed.value())
                 : "Settling and delays: on";
    } else {
        on = fmt::format("At {:.6g} deg/s, sampled at {:.6g} Hz, on", comparison.speed.value(),
                         comparison.sample_rate.value());
    }
    if (comparison.step_nm) on += fmt::format(" a step of {:.6g} Nm", *comparison.step_nm);
    if (comparison.step_nm && comparison.ramp_nm_s) on += " and";
    if (comparison.ramp_nm_s) on += fmt::format(" a ramp of {:.6g} Nm/s", *comparison.ramp_nm_s);
    return text + paragraph(common, on + ".") + notes_in_force(common, comparison);
}

// The same with short names for its methods.
Comparison with_short_names(const Comparison& comparison) {
    Comparison named = comparison;
    for (std::size_t i = 0; i < named.methods.size(); ++i)
        named.methods[i].method = short_name(comparison.methods[i], comparison);
    return named;
}

// The methods with short names, as they would be typed.
std::string legend(const Comparison& comparison) {
    std::string text;
    for (const MethodFigures& figures : comparison.methods) {
        const std::string name = short_name(figures, comparison);
        if (name != figures.method) text += fmt::format("{} is --method {}\n", name, figures.method);
    }
    return text.empty() ? text : "\n" + text;
}

// The verdict, one row a method, and what was measured on what. Columns that nothing fills are left out.
std::string comparison_view(const CommonOptions& common, const Comparison& comparison) {
    const Comparison named = with_short_names(comparison);
    std::size_t before = joint_columns(common);
    std::string text;
    if (!comparison.best_sentence.empty()) {
        text = paragraph(common, comparison.best_sentence, before) + "\n";
        before = 0;
    }
    text += paragraph(common, differences(comparison), before) + "\n" + rows_of(named) + "\n" +
            conditions(common, named);
    return text + legend(comparison) + ledger_text(named);
}

// The nearer to what the user typed outside the methods, the better.
int rank_of(const Contender& contender) {
    if (!contender.gear) return 3;
    if (contender.table) return 2;
    return contender.made_for() ? 1 : 0;
}

const Method& control_method() {
    const auto all = ripplenotch::methods();
    return **std::find_if(all.begin(), all.end(),
                          [](const Method* method) { return method->part == MethodPart::control; });
}

std::optional<GearAccount> common_gear(const std::vector<Contender>& contenders) {
    const auto best =
        std::min_element(contenders.begin(), contenders.end(),
                         [](const Contender& a, const Contender& b) { return rank_of(a) < rank_of(b); });
    if (!best->gear) return std::nullopt;
    for (const Contender& contender : contenders) refuse_other_gear(contender, *best->gear);
    return best->gear;
}

// Throws UsageError when `methods` is empty, and what choose_method and refuse_other_gear throw.
Field load_contenders(const std::vector<std::string>& methods, const GearOptions& gear,
                      const CommonOptions& common, Provenance& provenance) {
    if (methods.empty()) {
        raise<UsageError>(
            "nothing to compare; give --method, for example --method fixed,centers=25Hz:50Hz,q=0.25 "
            "--method lowpass,cutoff=13rad/s");
    }
    const GearChoice choice(gear);
    Field field;
    std::set<std::string> recorded;
    const auto add = [&](const std::string& text) {
        const Contender& added = field.contenders.emplace_back(choose_method(text, std::nullopt, choice));
        if (!field.table) field.table = added.table;
        if (!added.others.empty())
            warn(common,
                 fmt::format(
                     "{}: the ripple of other joints' motors that its map holds is left in the torque; "
                     "filter subtracts it",
                     added.text));
        for (const std::string& file : added.files)
            if (recorded.insert(file).second) provenance.inputs.push_back(input_record(file));
    };
    const auto is_control = [](const std::string& text) {
        return find_method(parse_spec(text).name).part == MethodPart::control;
    };
    if (std::none_of(methods.begin(), methods.end(), is_control)) add(std::string(control_method().name));
    for (const std::string& text : methods) add(text);
    field.gear = common_gear(field.contenders);
    return field;
}

// Warns when a method's table is for a slightly different rate, and throws DataError when it is for another.
void check_table_rates(const Field& field, Hertz sample_rate, const std::string& source,
                       const CommonOptions& common) {
    for (const Contender& contender : field.contenders) {
        if (!contender.table) continue;
        const auto warning =
            table_rate_warning({.table = contender.table->spec().sample_rate, .log = sample_rate}, source);
        if (warning) warn(common, *warning);
    }
}

// Those that cannot be designed at this rate are left out with a warning where another one is left.
void leave_out_refused(Field& field, Hertz sample_rate, const CommonOptions& common) {
    std::vector<std::string> reasons;
    std::vector<Contender> kept;
    bool compared = false;
    for (const Contender& contender : field.contenders) {
        const std::string why = contender.refusal(sample_rate);
        if (!why.empty()) {
            reasons.push_back(why + "; it is left out");
            continue;
        }
        compared = compared || contender.method->part != MethodPart::control;
        kept.push_back(contender);
    }
    if (reasons.empty() || !compared) return;
    say_warnings(common, reasons);
    field.contenders = std::move(kept);
}

void attach_costs(Options& options, CostRequest& request) {
    options.number("--crossover", request.crossover, Dimension::frequency,
                   "the control loop's: phase lag and gain there, e.g. 12Hz");
    attach_gates(options, request.gates);
}

// Phase lag and gain at the crossover, the ledger, and from which speed on a delay limit is kept, as asked.
void add_costs(Comparison& comparison, const CostRequest& request, const Field& field, bool ledger) {
    comparison.crossover = request.crossover;
    if (request.gates.max_delay && comparison.lines) {
        TableSpec notches;
        notches.gear_ratio = comparison.lines->ratio;
        notches.orders = comparison.lines->orders;
        notches.sample_rate = comparison.sample_rate;
        comparison.max_delay = *request.gates.max_delay;
        comparison.no_notch_below = slowest_within(notches, *comparison.max_delay);
    }
    for (std::size_t i = 0; i < field.contenders.size(); ++i) {
        const Contender& contender = field.contenders[i];
        MethodFigures& figures = comparison.methods[i];
        const auto frozen = contender.frozen(comparison.sample_rate, comparison.speed);
        if (request.crossover && frozen) {
            const auto at =
                at_crossover(frozen->cascade, *request.crossover, SampledAt(comparison.sample_rate));
            figures.phase_lag_deg = at.phase_lag_deg;
            figures.crossover_db = at.gain_db;
        }
        if (ledger)
            figures.ledger = delay_ledger(contender, comparison.sample_rate, {request.crossover, true});
        if (!ledger) figures.switch_ledger.clear();
        if (request.gates.max_delay && contender.made_for()) {
            figures.within_from = within_from(contender, comparison.sample_rate, *request.gates.max_delay);
        }
    }
}

// One sentence for each limit that a method breaks. The control is there to be compared with, not to be held
// to anything.
std::vector<std::string> violations(const Comparison& comparison, const CostRequest& request,
                                    const Field& field) {
    std::vector<std::string> found;
    const auto add = [&found](std::vector<std::string> more) {
        for (std::string& sentence : more) found.push_back(std::move(sentence));
    };
    for (std::size_t i = 0; i < field.contenders.size(); ++i) {
        const Contender& contender = field.contenders[i];
        if (contender.method->part == MethodPart::control) continue;
        const DegPerSec slowest = comparison.on_log ? comparison.slowest : comparison.speed;
        const DegPerSec fastest = comparison.on_log ? comparison.fastest : comparison.speed;
        add(delay_violations(request.gates, contender, comparison.sample_rate, slowest, fastest));
        add(attenuation_violations(request.gates, contender.text, comparison.methods[i].attenuation));
    }
    return found;
}

struct CompareRequest : LogRequest {
    std::string truth;
    std::vector<std::string> methods;
    std::optional<double> step_nm, ramp_nm_s;
    std::optional<DegPerSec> speed;
    CostRequest costs;
};

Comparison compare_on_signals(const CompareRequest& request, const Field& field) {
    if (!request.truth.empty()) raise<UsageError>("--truth goes with a LOG");
    if (!request.step_nm && !request.ramp_nm_s) {
        raise<UsageError>("nothing to compare on; give a LOG, or --step 10Nm, or --ramp 20Nm/s");
    }
    Comparison comparison;
    if (request.log.sample_rate) {
        comparison.sample_rate = *request.log.sample_rate;
    } else if (field.table) {
        comparison.sample_rate = field.table->spec().sample_rate;
    } else {
        raise<UsageError>("the sample rate is missing; give --sample-rate, for example 1kHz");
    }
    if (!request.speed && (field.gear || field.table)) {
        raise<UsageError>(
            "attenuation and switching depend on the joint speed; give --speed, for example 90deg/s");
    }
    check_table_rates(field, comparison.sample_rate, "the signal", request.common);
    comparison.speed = request.speed.value_or(DegPerSec(0.0));
    comparison.step_nm = request.step_nm;
    comparison.ramp_nm_s = request.ramp_nm_s;
    comparison.lines = field.gear;
    Progress::current().begin("measuring", "methods", field.contenders.size());
    for (const Contender& contender : field.contenders) {
        comparison.methods.push_back(measure_on_signals(contender, comparison.sample_rate, comparison.speed,
                                                        comparison.step_nm, comparison.ramp_nm_s,
                                                        comparison.lines ? &*comparison.lines : nullptr));
        Progress::current().add(1);
    }
    return comparison;
}

// The torque that a perfect sensor would have given, row by row: another log of the same motion.
std::vector<double> true_torque(const CompareRequest& request, const ReadOptions& read, std::size_t rows,
                                Provenance& provenance) {
    if (request.truth.empty()) return {};
    Log truth = read_log_in_part(request.truth, read);
    provenance.inputs.push_back(input_record(request.truth));
    provenance.inputs.back().rows = truth.trace.size();
    if (truth.trace.size() != rows) {
        raise<DataError>("--truth {} has {} rows, {} has {}; they have to be of the same motion, row by row",
                         request.truth, truth.trace.size(), request.path, rows);
    }
    return std::move(truth.trace.torque_nm);
}

// As filter has it: other coefficients at other speeds, or a law of the angle.
bool follows_motion(const Contender& contender) {
    return contender.method->steady == nullptr && contender.method->part != MethodPart::control;
}

Comparison compare_on_log(const CompareRequest& request, Field& field, Provenance& provenance,
                          ComparedCourse& course) {
    ReadOptions read = read_options(request.log, field.gear);
    // What has the same coefficients at every speed is measured without one.
    read.needs_velocity =
        field.gear || std::any_of(field.contenders.begin(), field.contenders.end(), follows_motion);
    const Log log = read_log_in_part(request.path, read);
    take_log(request.common, request.path, log, provenance);
    for (const Contender& contender : field.contenders) refuse_other_joint(contender, log.trace.joint);
    if (field.gear)
        if (const std::string against = against_gear({&log, 1}, *field.gear); !against.empty())
            warn(request.common, against);
    ComparedLog compared{log.trace.view()};
    if (!request.truth.empty() && !field.gear) raise_no_gear("--truth");
    const std::vector<double> truth = true_torque(request, read, log.trace.size(), provenance);
    compared.truth_nm = truth;
    if ((request.common.plot || request.common.in_memory) && !truth.empty())
        compared.watch = [&course](auto&&... all) { course.add(all...); };
    leave_out_refused(field, log.recording.clock.nominal_rate, request.common);
    // The filters are those that the filter command would run.
    compared.trace.sample_rate = log.recording.clock.nominal_rate;
    Comparison comparison;
    comparison.on_log = true;
    comparison.rows = log.trace.size();
    comparison.sample_rate = compared.trace.sample_rate;
    check_table_rates(field, comparison.sample_rate, log.layout.source, request.common);
    comparison.speed = request.speed ? *request.speed : median_moving_speed(compared.trace);
    for (const double velocity : compared.trace.velocity_deg_s) {
        if (std::isnan(velocity)) break;
        const DegPerSec speed(std::abs(velocity));
        comparison.slowest =
            comparison.fastest == DegPerSec(0.0) ? speed : std::min(comparison.slowest, speed);
        comparison.fastest = std::max(comparison.fastest, speed);
    }
    comparison.step_nm = request.step_nm.value_or(usual_step_nm);
    comparison.ramp_nm_s = request.ramp_nm_s.value_or(usual_ramp_nm_s);
    comparison.lines = field.gear;
    if (!comparison.lines)
        warn(request.common,
             "no line is known, so no ripple was measured; give --gear-ratio, --orders 200/turn (lines per "
             "turn of "
             "the joint) or --joint-file");
    std::vector<RippleEstimate> ripple;
    if (field.gear) ripple = estimate_ripple({&compared.trace, 1}, field.gear->ratio, field.gear->orders);
    LogLevels levels =
        measure_on_log(field.contenders, compared, field.gear ? &*field.gear : nullptr, std::move(ripple),
                       BenchSignals{comparison.speed, *comparison.step_nm, *comparison.ramp_nm_s});
    if (field.gear && levels.lines.windows == 0)
        warn(request.common, fmt::format("the ripple cannot be measured on this log: {}", levels.why_none));
    comparison.methods = levels.methods;
    comparison.windows = levels.lines.windows;
    comparison.raw_ripple_rms_nm = levels.raw_ripple_rms_nm;
    comparison.measured_share = levels.lines.measured_share;
    const Gates& gates = request.costs.gates;
    judge(comparison, field.contenders, compared,
          {gates.max_delay, gates.min_attenuation_db, std::nullopt, true}, std::move(levels));
    return comparison;
}

Answer compare_once(const CompareRequest& request, const std::string& command_line) {
    Provenance provenance{{}, command_line};
    Field field = load_contenders(request.methods, request.gear, request.common, provenance);
    if (request.costs.gates.min_attenuation_db && !field.gear) raise_no_gear("--min-attenuation");
    if (field.gear) say(request.common, gear_in_words(*field.gear));
    ComparedCourse course;
    Comparison comparison = request.path.empty() ? compare_on_signals(request, field)
                                                 : compare_on_log(request, field, provenance, course);
    add_costs(comparison, request.costs, field, request.common.verbose);
    const std::string unit = provenance.recordings.empty() ? "Nm" : provenance.recordings.front().torque_unit;
    const auto broken = violations(comparison, request.costs, field);
    say_warnings(request.common, broken);
    Answer answer{in_torque_unit(comparison_view(request.common, comparison), unit)};
    if (!broken.empty()) answer.code = ExitCode::limit_violated;
    const auto found = std::make_shared<const Comparison>(std::move(comparison));
    answer.document = [found, provenance, unit] {
        return in_torque_unit(comparison_text(*found, provenance), unit);
    };
    answer.figure = [found, path = request.path, field = std::move(field), course = std::move(course)] {
        return course.empty() ? comparison_figure(*found, field.contenders) : course.figure(path, *found);
    };
    answer.provenance = std::move(provenance);
    return answer;
}

Answer run_compare(const CompareRequest& request, const std::string& command_line) {
    if (request.path.empty() && request.log.range.given())
        raise<UsageError>("--from and --to: there is no LOG to select rows from");
    // A signal is no joint's, and is compared on as a log of one is.
    return ask_joints(request, "comparisons", [&](CompareRequest& one) {
        if (one.joint)
            for (std::string& method : one.methods) method = with_joint(method, *one.joint);
        return compare_once(one, command_line);
    });
}

std::function<Answer()> attach_compare(Options& options) {
    auto request = std::make_shared<CompareRequest>();
    options.argument("LOG", request->path, false,
                     "a log; - is standard input. Without one, --step or --ramp");
    options.texts(
        "--method", request->methods, "NAME,KEY=VALUE,...",
        fmt::format("a method to compare; repeatable; methods: {}; see docs/methods", name_list(methods())));
    attach_gear(options, request->gear);
    options.number("--speed", request->speed, Dimension::speed,
                   "joint speed for attenuation and delays; on a log its median moving speed");
    options.number("--step", request->step_nm, Dimension::torque, "torque step to settle from");
    options.number("--ramp", request->ramp_nm_s, Dimension::torque_rate,
                   "torque ramp to measure the delay on");
    options.text("--truth", request->truth, "LOG",
                 "the same log without ripple and noise: each method's error against its torque");
    attach_costs(options, request->costs);
    attach_plot(options, request->common);
    attach_log(options, request->log);
    attach_common(options, request->common, {"a comparison", ".txt .json", true});
    return [request, &options] { return run_compare(*request, options.command_line()); };
}

}  // namespace

const Command commands::compare = {
    .name = "compare",
    .summary = "several methods side by side on a log, a step or a ramp",
    .description =
        "Attenuation, delay and settling of each method. The control, none, is always shown.\nThe paper's "
        "figures: ripplenotch compare --step 10Nm --ramp 20Nm/s --speed 90deg/s --sample-rate "
        "1kHz\n--gear-ratio 100 --orders 1,2 --method fixed,centers=25Hz:50Hz,q=0.25 --method "
        "lowpass,cutoff=13rad/s",
    .attach = attach_compare,
};

}  // namespace ripplenotch
