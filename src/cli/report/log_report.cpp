// SPDX-License-Identifier: MIT
#include "cli/report/log_report.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include "cli/command.hpp"
#include "cli/run.hpp"
#include "core/files/byte_sink.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

using Words = std::vector<std::string>;

/// A folder for what the commands write, which ends with it.
class Workspace {
  public:
    Workspace() : folder_(temporary_folder() + "/ripplenotch-report-XXXXXX") {
        if (::mkdtemp(folder_.data()) == nullptr)
            raise<FileError>("{}: cannot make a folder for the results: {}", folder_,
                             std::generic_category().message(errno));
    }
    ~Workspace() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    Workspace(const Workspace&) = delete;
    Workspace& operator=(const Workspace&) = delete;

    [[nodiscard]] std::string path(std::string_view name) const {
        return fmt::format("{}/{}", folder_, name);
    }
    /// What a command wrote, with its files named as if they were here: the same bytes from every run.
    [[nodiscard]] std::string text(std::string_view name) const {
        std::string text = read_all(path(name));
        const std::string prefix = folder_ + "/";
        for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix, at))
            text.erase(at, prefix.size());
        return text;
    }

  private:
    std::string folder_;
};

Words operator+(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

class Run {
  public:
    explicit Run(const LogReport& report) : report_(report), gear_(report.gear) {}

    std::vector<PageSection> sections() {
        // Its refusal is that of the whole report: the others would repeat it.
        command({"identify", report_.log, "--json", "-o", workspace_.path("joint.json")},
                report_.reading + report_.ratio, report_.quiet);
        const auto advice =
            try_step({"recommend", report_.log}, report_.reading + report_.gear, "recommendation.json");
        take("joint.json");
        if (advice) show_recommended(*advice);
        show_spectrogram();
        try_step({"info", report_.log}, report_.reading, "info.json");
        return std::move(sections_);
    }

  private:
    static void command(const Words& words, const Words& options, bool quiet) {
        const ExitCode code =
            run_within(words + options + Words{"--force"} + (quiet ? Words{"-q"} : Words{}));
        if (code != ExitCode::done && code != ExitCode::inconclusive)
            raise<DataError>("{} ended with exit code {}", words.front(), static_cast<int>(code));
    }

    /// Runs a command that writes JSON, and adds its sections; none where it refuses.
    std::optional<Json> try_step(const Words& words, const Words& options, const std::string& file) {
        try {
            command(words + Words{"--json", "-o", workspace_.path(file)}, options, true);
        } catch (const Error& error) {
            PageSection section;
            section.title = fmt::format("{}: {}", words.front(), report_.log);
            section.verdict = error.what();
            sections_.push_back(std::move(section));
            return std::nullopt;
        }
        return take(file);
    }

    Json take(const std::string& file) {
        const std::string text = workspace_.text(file);
        for (PageSection& section : sections_of_result(text, report_.log))
            sections_.push_back(std::move(section));
        return Json::parse(text);
    }

    /// The figure that a command draws; a command without one, or a figure without points, is no loss.
    void try_figure(const Words& words, const Words& options, const std::string& file) {
        try {
            command(words + Words{"--plot", workspace_.path(file)}, options, true);
            take(file);
        } catch (const Error&) {
            return;
        }
    }

    /// What the recommended method does to the log.
    void show_recommended(const Json& advice) {
        if (!advice.contains("take")) return;  // several joints: a section each has been added
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
        const auto method = with_files(advice["take"].get<std::string>(), advice);
        if (!method) return;
        try_figure(Words{"filter", report_.log, "-o", workspace_.path("filtered.csv"), "--decimals", "6"} +
                       Words{"--method", *method},
                   report_.reading + gear_, "filtered.json");
    }

    /// The method with the map that it needs, made of the first part of the log; none for other files.
    std::optional<std::string> with_files(std::string method, const Json& advice) {
        constexpr std::string_view map = "map=map.json";
        const std::size_t at = method.find(map);
        if (at == std::string::npos)
            return method.find(".json") == std::string::npos ? std::optional(method) : std::nullopt;
        if (!map_made_)
            map_made_ = try_step({"map", report_.log},
                                 without_range() + Words{"--to", seconds(advice)} + gear_, "map.json")
                            .has_value();
        if (!map_made_) return std::nullopt;
        return method.replace(at, map.size(), "map=" + workspace_.path("map.json"));
    }

    static std::string seconds(const Json& advice) {
        return shortest(advice.at("split_s").get<double>()) + "s";
    }

    // recommend splits what --from and --to leave; its parts have ends of their own.
    Words without_range() const {
        Words words;
        for (std::size_t i = 0; i < report_.reading.size(); ++i) {
            if (report_.reading[i] == "--from" || report_.reading[i] == "--to")
                ++i;
            else
                words.push_back(report_.reading[i]);
        }
        return words;
    }

    void show_spectrogram() {
        try_figure({"spectrum", report_.log, "--map", "campbell", "-o", workspace_.path("campbell.csv")},
                   report_.reading, "campbell.json");
    }

    const LogReport& report_;
    Words gear_;
    Workspace workspace_;
    std::vector<PageSection> sections_;
    bool map_made_ = false;
};

}  // namespace

bool is_log(const std::string& path) {
    if (path == "-" || path.ends_with(".json")) return false;
    std::ifstream file(path, std::ios::binary);
    char first = ' ';
    while (file.get(first) && std::isspace(static_cast<unsigned char>(first)) != 0) {
    }
    return file && first != '{' && first != '[';
}

std::vector<PageSection> sections_of_log(const LogReport& report) { return Run(report).sections(); }

}  // namespace ripplenotch
