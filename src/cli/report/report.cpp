// SPDX-License-Identifier: MIT
// ripplenotch report: one self-contained HTML page from any mix of results.

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/joint_runs.hpp"
#include "document/json/json.hpp"
#include "page/result_section.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/page/page.hpp"

namespace ripplenotch {
namespace {

using Words = std::vector<std::string>;

struct LogReport {
    std::string log, name;        ///< its path, and without folders
    std::string piped;            ///< the log itself, where it came through a pipe
    ReadOptions read;             ///< how it is read, and which of its joints
    Words reading, gear, motors;  ///< the same as words, without --joint, and of its gear; other motors
    bool quiet = false;
};

Words operator+(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// The words less these options and their values.
Words without(const Words& words, const Words& options) {
    Words kept;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (std::find(options.begin(), options.end(), words[i]) != options.end())
            ++i;
        else
            kept.push_back(words[i]);
    }
    return kept;
}

/// One joint of a log: the answer with its picture first, then a section for each question.
class JointReport {
  public:
    /// `joint`: one of several, or empty.
    JointReport(const LogReport& report, std::string title, const std::string& joint)
        : report_(report),
          read_(report.read),
          title_(std::move(title)),
          reading_(report.reading),
          gear_(report.gear) {
        if (!joint.empty()) read_.joint = joint;
        if (read_.joint) reading_ = reading_ + Words{"--joint", *read_.joint};
    }

    /// Throws where identify refuses the log: the other commands would repeat its message.
    std::vector<PageSection> sections() {
        const Json found =
            taken(answer(Words{"identify", report_.log} + reading_ + ratio() + report_.motors, report_.quiet),
                  "Which ripple, and which gear");
        const Json advice =
            tried(Words{"recommend", report_.log} + reading_ + report_.gear, "Which method, and why");
        const Json log = tried(Words{"info", report_.log} + reading_, "How the log was read");
        if (advice.contains("take")) show_recommended(advice);
        if (const Answer map = attempt({"spectrum", report_.log, "--map", "campbell"}); map.figure)
            add("The spectrum at each speed", map.figure());
        add_notes(found, advice, log);
        sections_.insert(sections_.begin(), lead(found, advice, log));
        // The answer stands above.
        for (PageSection& section : sections_)
            if (!section.leads && section.verdict == sections_.front().verdict) section.verdict.clear();
        order_by_question();
        return std::move(sections_);
    }

  private:
    // Of the gear identify takes the ratio alone.
    [[nodiscard]] Words ratio() const {
        const auto at = std::find(report_.gear.begin(), report_.gear.end(), "--gear-ratio");
        return at == report_.gear.end() ? Words{} : Words{at, at + 2};
    }
    static Answer answer(const Words& words, bool quiet) {
        Answer found = ask(words + Words{"--json"} + (quiet ? Words{"-q"} : Words{}));
        if (found.code != ExitCode::done && found.code != ExitCode::inconclusive)
            raise<DataError>("{} ended with exit code {}", words.front(), static_cast<int>(found.code));
        return found;
    }

    /// Adds the section of a command; one with its message where it refuses.
    Json tried(const Words& words, const std::string& title) {
        try {
            return taken(answer(words, true), title);
        } catch (const Error& error) {
            PageSection section;
            section.title = title;
            section.verdict = error.what();
            sections_.push_back(std::move(section));
            return Json::object();
        }
    }

    Json taken(const Answer& found, const std::string& title) {
        text_ = found.document();
        for (PageSection& section : sections_of_result(text_, "")) {
            section.title = title;
            // The page names the log once.
            for (Figure& drawn : section.figures)
                drawn.title.resize(std::min(drawn.title.size(), drawn.title.find(": ")));
            sections_.push_back(std::move(section));
        }
        return Json::parse(text_);
    }

    /// What a command draws; one that refuses is no loss.
    [[nodiscard]] Answer attempt(const Words& words) const {
        try {
            return ask(words + reading_ + Words{"-q"});
        } catch (const Error&) {
            return {};
        }
    }

    void add(const std::string& title, Figure drawn) {
        PageSection section;
        section.title = title;
        section.verdict = std::exchange(drawn.sentence, "");
        drawn.title = title;
        section.figures.push_back(std::move(drawn));
        sections_.push_back(std::move(section));
    }

    /// What the recommended method does to the log.
    void show_recommended(const Json& advice) {
        // As recommend found it, in the first part of the log.
        const Json& found = advice["gear"];
        if (report_.gear.empty() && found.is_object()) {
            const bool known = found["ratio"].is_number();
            const GearRatio ratio = known ? GearRatio(found["ratio"].get<double>()) : no_ratio;
            std::vector<Order> orders;
            for (const Json& order : found["orders"]) orders.emplace_back(order.get<double>());
            gear_ = known ? Words{"--gear-ratio", shortest(ratio.value())} : Words{};
            if (!orders.empty()) gear_ = gear_ + Words{"--orders", orders_text(orders, ratio, ",")};
        }
        if (!advice["take"].is_string()) return;
        const auto method = advice["take"].get<std::string>();
        const auto held = file_of(method, advice);
        if (!held && method.find(".json") != std::string::npos) return;
        const Answer filtered = attempt(Words{"filter", report_.log, "--method", method} + gear_);
        if (!filtered.figure) return;
        filtered_nm_ = filtered.columns.front().values;
        filtered_ = filtered.figure();
        if (filtered_->panels.size() < 2) return;
        Figure whole = *filtered_;
        whole.panels.erase(whole.panels.begin());
        add("The whole log, before and after", std::move(whole));
    }

    /// The table or map that the method needs, the map made of the first part of the log; none for other
    /// files.
    std::unique_ptr<HeldFile> file_of(const std::string& method, const Json& advice) {
        Json made;
        std::string name = "table.json";
        if (method.find(name) != std::string::npos) {
            std::istringstream design(advice.at("take_commands").at(0).get<std::string>());
            const Words words{std::istream_iterator<std::string>(design), {}};
            made = tried(Words(words.begin() + 1, words.end() - 2), "The table of notches");
        } else if (name = "map.json"; method.find(name) != std::string::npos) {
            // recommend splits what --from and --to leave; its parts have ends of their own.
            const std::string split_s = shortest(advice.at("split_s").get<double>()) + "s";
            made = tried(Words{"map", report_.log} + report_.motors + without(reading_, {"--from", "--to"}) +
                             Words{"--to", split_s} + gear_,
                         "The ripple map");
        }
        return made.empty() ? nullptr : std::make_unique<HeldFile>(name, text_);
    }

    PageSection lead(const Json& found, const Json& advice, const Json& log) {
        PageSection top;
        top.title = title_;
        top.leads = true;
        top.about = about(log);
        const bool advised = advice.contains("verdict");
        top.verdict = value_text(advised ? advice["verdict"] : found["verdict"]);
        top.state = state_of(advised ? advice : found);
        if (auto picture = first_picture(found)) top.figures.push_back(std::move(*picture));
        if (auto orders = before_and_after(advice); !orders.rows.empty())
            top.tables.push_back(std::move(orders));
        if (advice.contains("take_commands"))
            for (const Json& line : advice["take_commands"]) top.commands.push_back(value_text(line));
        return top;
    }

    static std::string about(const Json& log) {
        if (!log.contains("rows")) return "";
        std::string text = fmt::format("{} rows in {:.4g} s", log["rows"].get<std::size_t>(),
                                       log["duration_s"].get<double>());
        if (log["sample_rate_hz"].is_number())
            text += fmt::format(" at {:.4g} Hz", log["sample_rate_hz"].get<double>());
        const auto& speed = log["speed_deg_s"];
        if (speed.is_object() && speed["min"].is_number())
            text += fmt::format("; speed {:.3g} to {:.3g} deg/s", speed["min"].get<double>(),
                                speed["max"].get<double>());
        return text + ".";
    }

    /// The spectrum over orders; none where the joint nowhere turns far enough.
    static std::optional<Panel> over_orders(const TraceView& trace) {
        const Stack stack = stack_sweeps(cut_sweeps({&trace, 1}, MotionLinesOptions{}.sweeps).pieces);
        if (stack.first >= stack.averages.size()) return std::nullopt;
        return order_spectrum_figure("", stack, {}).panels.front();
    }

    /// A detail of the torque, and the spectrum over orders, each before and after the method.
    std::optional<Figure> first_picture(const Json& found) {
        Figure picture{"torque", "", "", {}};
        if (filtered_) {
            picture.panels.push_back(filtered_->panels.front());
            picture.panels.back().title = "Torque, where the ripple is largest";
        }
        Log log;
        try {
            log = read_log(report_.log, read_);
        } catch (const Error&) {
            return picture.panels.empty() ? std::nullopt : std::optional(picture);
        }
        if (auto panel = over_orders(log.trace.view())) {
            panel->title = "Spectrum over orders";
            panel->y.label = "amplitude";
            panel->curves.resize(1);
            panel->curves[0].name = filtered_ ? "before" : "torque";
            panel->curves[0].ink = Ink::orange;
            name_lines(*panel, found);
            if (filtered_nm_.size() == log.trace.torque_nm.size()) {
                log.trace.torque_nm = std::move(filtered_nm_);
                Curve& after = panel->curves.emplace_back(over_orders(log.trace.view())->curves.front());
                after.name = "after";
                after.ink = Ink::blue;
                panel->y.from = std::min(panel->y.from.value_or(1e300),
                                         0.7 * *std::min_element(after.y.begin(), after.y.end()));
            }
            picture.panels.push_back(std::move(*panel));
        }
        if (picture.panels.empty()) return std::nullopt;
        // The answer below shall be on the same screen.
        for (Panel& panel : picture.panels) panel.height = 0.7;
        return picture;
    }

    /// The lines of identify, each with the colour of its order; the axis ends behind the highest of them.
    static void name_lines(Panel& panel, const Json& found) {
        panel.lines.clear();
        double highest = 0.0;
        for (const Json& line : found.value("lines", Json::array())) {
            if (!line["order_output"].is_number()) continue;
            const double place = line["order_output"].get<double>();
            const bool named = line["order"].is_number();
            const double order = named ? line["order"].get<double>() : 0.0;
            highest = std::max(highest, place);
            panel.lines.push_back(
                {.name = named ? fmt::format("order {:.4g}", order) : fmt::format("{:.4g} per turn", place),
                 .run = NamedLine::Run::at_x,
                 .value = place,
                 .ink = named ? order_ink(order) : unknown_ink});
        }
        constexpr double beyond = 1.5;  // so that the highest line stands clear of the edge
        if (highest > 0.0) panel.x.to = std::min(panel.x.to.value_or(1e300), beyond * highest);
    }

    /// What the recommended method leaves of each order, and what it costs.
    static PageTable before_and_after(const Json& advice) {
        PageTable table{"", {"order", "before, Nm", "after, Nm", "longest delay, ms"}, {}};
        if (!advice.contains("take") || !advice["take"].is_string()) return table;
        for (const Json& method : advice["methods"]) {
            if (method["method"] != advice["take"]) continue;
            for (const Json& fall : method["attenuation_db"]) {
                for (const Json& order : advice["orders"]) {
                    if (order["order"] != fall["order"] || !order["amplitude_nm"].is_number()) continue;
                    const double before_nm = order["amplitude_nm"].get<double>();
                    const bool known = fall["db"].is_number();
                    table.rows.push_back(
                        {fmt::format("{:.4g}", order["order"].get<double>()), coarse_text(before_nm),
                         known
                             ? coarse_text(before_nm * portable::pow(10.0, -fall["db"].get<double>() / 20.0))
                             : "0",
                         method["longest_delay_ms"].is_number()
                             ? fmt::format("{:.3g}", method["longest_delay_ms"].get<double>())
                             : "-"});
                }
            }
        }
        return table;
    }

    /// What was assumed, what was not tried and why, and what a further log should have.
    void add_notes(const Json& found, const Json& advice, const Json& log) {
        PageSection section;
        section.title = not_shown;
        const auto list = [&](const Json& of, const char* name, std::string_view before) {
            for (const Json& one : of.value(name, Json::array()))
                section.notes.push_back(fmt::format("{}{}", before, value_text(one)));
        };
        list(found, "notes", "");
        list(log, "warnings", "");
        list(advice, "assumed", "Assumed: ");
        list(advice, "left_out", "Not tried: ");
        for (const Json& use : log.value("uses", Json::array()))
            if (!use["possible"].get<bool>())
                section.notes.push_back(
                    fmt::format("Not possible: {}: {}", value_text(use["name"]), value_text(use["reason"])));
        if (!section.notes.empty()) sections_.push_back(std::move(section));
    }

    /// The lead first; what the log does not tell and how it was read last.
    void order_by_question() {
        const auto rank = [](const PageSection& section) {
            if (section.leads) return 0;
            if (section.title.starts_with("Which ripple")) return 1;
            if (section.title.starts_with("Which method")) return 2;
            if (section.title == not_shown) return 4;
            return section.title.starts_with("How the log") ? 5 : 3;
        };
        std::stable_sort(sections_.begin(), sections_.end(),
                         [&](const PageSection& a, const PageSection& b) { return rank(a) < rank(b); });
    }

    static constexpr std::string_view not_shown = "What the log does not show";

    const LogReport& report_;
    ReadOptions read_;
    std::string title_, text_;  ///< of the document that was taken last
    Words reading_, gear_;
    std::vector<PageSection> sections_;
    std::optional<Figure> filtered_;
    std::vector<double> filtered_nm_;
};

// False for what commands wrote: a JSON object whose first lines name its schema.
bool is_log(std::string_view text) {
    const std::string_view head = text.substr(0, 4096);
    const std::size_t first = head.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) return false;
    return head[first] != '{' || head.find("\"ripplenotch/") == std::string_view::npos;
}

// The name of a log on a page: without folders.
std::string shown_name(const std::string& path) {
    return path == "-" ? "standard input" : std::filesystem::path(path).filename().string();
}

// Asks the commands about each log, and each joint of it, one after the other: the answer with its picture
// first, then a section for each question; before all that a table where there are several joints. What one
// of the commands refuses is a section with its message; without a log that can be read, or a torque in it,
// Error is thrown.
std::vector<PageSection> sections_of_logs(const std::vector<LogReport>& reports) {
    PageSection overview;
    overview.leads = true;
    overview.tables.push_back({"", {"joint", "answer"}, {}});
    auto& rows = overview.tables.front().rows;
    std::vector<PageSection> all;
    const auto add = [&](const LogReport& report, const std::string& title, const std::string& joint) {
        auto sections = JointReport(report, title, joint).sections();
        rows.push_back({title, sections.front().verdict});
        all.insert(all.end(), std::make_move_iterator(sections.begin()),
                   std::make_move_iterator(sections.end()));
    };
    for (const LogReport& report : reports) {
        std::optional<HeldFile> held;
        if (!report.piped.empty()) held.emplace(report.log, report.piped);
        const AskedJoints joints = joints_asked_for(report.log, report.read);
        if (joints.names.empty() || joints.names.size() + joints.left_out.size() == 1) {
            add(report, report.name, "");
            continue;
        }
        for (const std::string& joint : joints.names) {
            // A joint that one command refuses is said in the table; the others have their sections.
            try {
                add(report, reports.size() > 1 ? fmt::format("{}, {}", report.name, joint) : joint, joint);
            } catch (const DataError& error) {
                rows.push_back({joint, error.what()});
            }
        }
        for (const LeftOutJoint& one : joints.left_out) rows.push_back({one.joint, one.why});
    }
    if (rows.size() < 2) return all;
    overview.title = "The joints";
    all.insert(all.begin(), std::move(overview));
    return all;
}

struct ReportRequest {
    CommonOptions common;
    ReadOptions reading;
    GearOptions gear;
    std::vector<std::string> results;
    bool other_motors = false;
};

// Where the build and the installation put it, as seen from the program itself or from the Python module.
std::optional<std::string> installed_plotly() {
    std::error_code failed;
    Dl_info self{};
    const bool known = ::dladdr(reinterpret_cast<const void*>(&installed_plotly), &self) != 0;
    for (const std::filesystem::path& file : {std::filesystem::read_symlink("/proc/self/exe", failed),
                                              std::filesystem::path(known ? self.dli_fname : "")}) {
        auto folder = file.parent_path();
        for (int up = 0; up < 3; ++up, folder = folder.parent_path()) {
            const auto found = folder / "share" / "ripplenotch" / "plotly-cartesian.min.js";
            if (std::filesystem::exists(found, failed)) return found.string();
        }
    }
    return std::nullopt;
}

std::optional<std::string> plotly_js_of(const ReportRequest& request) {
    const auto path = installed_plotly();
    if (!path) {
        warn(request.common,
             "plotly.js is not installed (scripts/setup does it where there is npm), so the page carries "
             "pictures instead of plots");
        return std::nullopt;
    }
    std::string text = read_all(*path);
    // Such a text would end the script that it stands in.
    if (text.find("</script") != std::string::npos)
        raise<DataError>("{}: holds the end of a script; this is not plotly.js", *path);
    return text;
}

// Empty where it cannot be read: who reads all of it says why.
std::string beginning_of(const std::string& path) {
    constexpr std::size_t enough = 4096;  // bytes, for the schema of a document
    std::string text(enough, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    return text;
}

Answer run_report(const ReportRequest& request, const Options& options) {
    const std::string& output = request.common.output;
    if (ends_with_json(output)) raise<UsageError>("-o {}: a report is an HTML page; name it .html", output);
    check_output_name(output, "a report", ".html .htm");
    std::vector<LogReport> logs;
    Page page{"ripplenotch report", {}};
    for (const std::string& path : request.results) {
        // A pipe is emptied by whoever reads it first; of a file, which may be long, the beginning tells.
        std::error_code failed;
        const bool piped = !std::filesystem::is_regular_file(path, failed);
        const std::string text = piped ? read_all(path) : beginning_of(path);
        if (!path.ends_with(".json") && is_log(text)) {
            logs.push_back({piped ? "log.csv" : path,
                            shown_name(path),
                            piped ? text : "",
                            request.reading,
                            without(options.given(reading_group), {"--joint"}),
                            options.given(gear_group),
                            {"--other-motors", request.other_motors ? "yes" : "no"},
                            request.common.quiet});
            continue;
        }
        for (PageSection& section : sections_of_result(piped ? text : read_all(path), input_name(path)))
            page.sections.push_back(std::move(section));
    }
    if (!logs.empty() && logs.size() < request.results.size())
        raise<UsageError>("a report is one of logs, or one of results; read {}",
                          fmt::join(request.results, ", "));
    if (!logs.empty()) {
        page.title = joined(logs, ", ", &LogReport::name);
        page.sections = sections_of_logs(logs);
    }
    return {.text = html_page(page, plotly_js_of(request)), .kind = Answer::Text::bytes};
}

std::function<Answer()> attach_report(Options& options) {
    const auto request = std::make_shared<ReportRequest>();
    options.arguments("RESULT", request->results, true,
                      "logs, of which info, identify, recommend and filter are run; or JSON that "
                      "commands wrote: joint.json, table.json, metrics, comparisons, diagnoses, figures "
                      "(--plot FILE.json); - is standard input");
    options.answers_by(request->common);
    attach_output(options, request->common.output, "where the page goes; - is standard output");
    {
        const Options::Group group(options, output_group);
        options.flag("--force", request->common.force, "overwrite existing files");
        options.flag("-q,--quiet", request->common.quiet, "no warnings on standard error");
    }
    options.flag("--other-motors", request->other_motors,
                 "look in each joint for ripple of the other joints' motors as well, which takes a while");
    attach_gear(options, request->gear);
    attach_log(options, request->reading);
    return [request, &options] { return run_report(*request, options); };
}

}  // namespace

const Command commands::report{
    .name = "report",
    .summary = "one HTML page on a log, or from any mix of results",
    .description =
        "For a log, the page shows which ripple is in it, which filter it needs, and what that filter does. "
        "Results are put into one self-contained page: verdicts first, key numbers, plots to zoom into, "
        "tables, and the command\nthat makes each again. The page loads nothing from anywhere.\nExample: "
        "ripplenotch report log.csv -o page.html\nExample: ripplenotch report joint.json table.json "
        "torque.json -o page.html",
    .attach = attach_report,
};

}  // namespace ripplenotch
