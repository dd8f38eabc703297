// SPDX-License-Identifier: MIT
#include "cli/recommend/recommend_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "cli/text_table.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t report_width = 110, widest_name = 60;

std::string wrapped_sentence(const std::string& sentence) {
    std::string text;
    for (const std::string& line : wrapped(sentence, report_width)) text += line + "\n";
    return text;
}

std::string next_commands(std::string_view head, const std::vector<std::string>& lines) {
    if (lines.empty()) return "";
    return fmt::format("\n{}\n    {}\n", head, fmt::join(lines, "\n    "));
}

std::string orders_text(const Recommendation& found) {
    std::vector<std::vector<std::string>> rows = {
        {"order", "ripple Nm", "standard error Nm", "detectable Nm", ""}};
    for (const RippleEstimate& one : found.orders) {
        const auto cell = [&](double nm) { return one.searched() ? fmt::format("{:.3f}", nm) : "-"; };
        rows.push_back({shortest(one.order), cell(one.amplitude_nm), cell(one.standard_error_nm),
                        cell(one.detectable_nm),
                        !one.searched() ? one.insufficient
                        : one.present() ? ""
                                        : "not above the noise"});
    }
    return "\n" + text_table(rows, "rrrrl");
}

std::string methods_text(const Recommendation& found) {
    std::vector<std::vector<std::string>> rows = {{"method"}};
    for (const RippleEstimate& one : found.orders)
        rows.front().push_back(fmt::format("order {:g}, dB", one.order));
    for (const char* const title : {"late, ms", "ripple, Nm rms", "off by, Nm", ""})
        rows.front().emplace_back(title);
    for (const JudgedMethod& method : found.methods) {
        const std::string& name = method.figures.method;
        rows.push_back({name.size() > widest_name ? name.substr(0, widest_name) + "..." : name});
        for (const OrderAttenuation& entry : method.figures.attenuation)
            rows.back().push_back(entry.db ? rounded(*entry.db, 1) : "-");
        rows.back().push_back(rounded(1e3 * method.delay.value(), 1));
        rows.back().push_back(fmt::format("{:.4f}", method.figures.ripple_rms_nm.value_or(0.0)));
        rows.back().push_back(fmt::format("{:.4f}", method.error_nm));
        rows.back().push_back(method.meets() ? "" : "no");
    }
    rows.front().back() = found.limits.max_delay || found.limits.min_attenuation_db ? "within limits" : "";
    return "\n" + text_table(rows, "lr");
}

std::string bulleted(std::string_view head, const std::vector<std::string>& sentences) {
    if (sentences.empty()) return "";
    std::string text = fmt::format("\n{}\n", head);
    for (const std::string& sentence : sentences) {
        std::string lead = "* ";
        for (const std::string& line : wrapped(sentence, report_width - 2)) {
            text += lead + line + "\n";
            lead = "  ";
        }
    }
    return text;
}

}  // namespace

std::string recommendation_view(const RecommendationReport& report) {
    const Recommendation& found = report.found;
    std::string text = wrapped_sentence(recommendation_verdict(found));
    text += next_commands("To take it:", report.take);
    text += next_commands("The other:", report.runner_up);
    if (!found.orders.empty()) text += orders_text(found);
    if (!found.methods.empty()) {
        text += methods_text(found);
        text += fmt::format(
            "\nTrained up to {:.6g} s, judged from there on in {} windows. Off by: the ripple left, and "
            "{:.3g} Nm\n"
            "for every ms of delay, since this torque moves at {:.3g} Nm/s.\n",
            report.split_s, found.windows, 1e-3 * found.torque_rate_nm_s, found.torque_rate_nm_s);
    }
    if (!report.check.empty()) text += next_commands("To measure it again:", {report.check});
    return text + bulleted("Assumed:", report.assumed) + bulleted("Not tried:", report.left_out);
}

}  // namespace ripplenotch
