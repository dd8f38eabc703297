// SPDX-License-Identifier: MIT
// The ROS package `filters`: one transfer function a section, in a filter chain. It does not depend on the
// joint speed.
#include <fmt/format.h>

#include <array>

#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 2> channel_choices = {"multi", "single"};

constexpr std::array keys = {
    Key{.name = "channels",
        .kind = KeyKind::choice,
        .default_text = "multi",
        .choices = channel_choices,
        .help = "multi: MultiChannelFilterChain; single: FilterChain, as chained_filter_controller has it"},
    Key{.name = "node",
        .kind = KeyKind::text,
        .default_text = "torque_filter",
        .help = "the node or controller whose parameters these are"},
};

std::string type_of(const Settings& settings) {
    return settings.text("channels") == "multi" ? "filters/MultiChannelTransferFunctionFilterDouble"
                                                : "filters/TransferFunctionFilterDouble";
}

Written write(const FilterSet& filters, const Settings& settings, std::span<const std::string> heading) {
    const ExportBand& band = only_band(filters, "ros-filters");
    check_identifier(settings.text("node"), "target ros-filters, node");
    std::string text = comment_lines(heading, "# ");
    text += fmt::format(
        "# {}, designed for {} Hz; runs at every speed.\n"
        "# y[n] = b0 x[n] + b1 x[n-1] + b2 x[n-2] - a1 y[n-1] - a2 y[n-2]; a begins with a0 = 1.\n",
        describe(band), shortest(filters.sample_rate.value()));
    text += settings.text("node") + ":\n  ros__parameters:\n    filter_chain:\n";
    for (std::size_t i = 0; i < band.sections.size(); ++i) {
        const Biquad& f = band.sections[i].section;
        text += fmt::format(
            "      filter{0}:  # {1}\n        name: ripple_{0}\n        type: {2}\n        params:\n", i + 1,
            describe(band.sections[i]), type_of(settings));
        text += fmt::format("          a: [{}]\n          b: [{}]\n",
                            joined(std::array{1.0, f.a1, f.a2}, ", ", decimal),
                            joined(std::array{f.b0, f.b1, f.b2}, ", ", decimal));
    }
    return {text, {}};
}

LoadedFilters read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                   const Settings&) {
    TextReader reader(bytes, source, Comments::hash, Precision::float64);
    return read_bands(
        filters, [](const ExportBand&) {},
        [&](std::size_t) {
            reader.expect("TransferFunctionFilterDouble");
            reader.expect("a:");
            const auto a = reader.numbers('[', ']', 3);
            if (a[0] != 1.0) reader.fail(shortest(a[0]), "a0 of 1");
            reader.expect("b:");
            const auto b = reader.numbers('[', ']', 3);
            return loaded(Biquad{b[0], b[1], b[2], a[1], a[2]}, {Form::df1, Precision::float64});
        });
}

}  // namespace

const Target targets::ros_filters = {
    .name = "ros-filters",
    .summary = "YAML for the ROS package filters; one band, for it does not follow the speed",
    .source = "ros/filters, transfer_function.hpp; ros2_controllers, chained_filter_controller",
    .endings = ".yaml .yml",
    .keys = keys,
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
