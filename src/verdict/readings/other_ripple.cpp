// SPDX-License-Identifier: MIT
#include "ripplenotch/verdict/other_ripple.hpp"
#include "ripplenotch/core/gear_account.hpp"

#include <stdio.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "core/files/byte_sink.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

namespace {

std::string names_of(std::span<const RippleMap> maps) {
    return joined(maps, ",", [](const RippleMap& map) { return map.joint; });
}

void require_joints(std::span<const RippleMap> maps, const Spool& log, ReadOptions options) {
    options.joint.reset();
    options.check_joint = {};
    const std::vector<std::string> names = asked_joints(log, options).names;
    for (const RippleMap& map : maps)
        if (std::find(names.begin(), names.end(), map.joint) == names.end())
            raise<DataError>(
                "{}: the map also holds ripple of the motor of {}, and the log has no joint of that name",
                log.open()->name(), map.joint);
}

// Each joint by its own gear, where it is measured before the gear.
ReadOptions reading_of(std::span<const RippleMap> maps, const ReadOptions& options) {
    ReadOptions read = options;
    read.joint = names_of(maps);
    read.every_joint = true;
    read.torque_of_each = false;
    read.needs_torque = false;
    read.check_joint = {};
    read.gear_ratio_of = [maps](const std::string& joint) -> std::optional<double> {
        for (const RippleMap& map : maps)
            if (map.joint == joint && map.gear_ratio != no_ratio) return map.gear_ratio.value();
        return std::nullopt;
    };
    return read;
}

/// Takes what the filters of the joints make of each row.
class SumOfJoints final : public LogWriter {
  public:
    explicit SumOfJoints(std::FILE* file) : file_(file) {}
    void put(const RowBlock& block, Torques ripple_nm, std::string_view /*bytes*/) override {
        sum_.assign(block.size(), 0.0);
        for (const std::vector<double>& one : ripple_nm)
            for (std::size_t k = 0; k < sum_.size(); ++k) sum_[k] += one[k];
        if (std::fwrite(sum_.data(), sizeof(double), sum_.size(), file_) != sum_.size())
            raise<FileError>("the temporary file of the other joints' ripple: {}", std::strerror(errno));
    }
    void finish() override {}

  private:
    std::FILE* file_;
    std::vector<double> sum_;
};

}  // namespace

OtherRipple::OtherRipple(std::span<const RippleMap> maps, const Spool& log, const ReadOptions& options)
    : file_(::fdopen(
          TemporaryFile(temporary_folder() + "/ripplenotch-ripple", std::nullopt).release_without_name(),
          "w+b")) {
    if (file_ == nullptr)
        raise<FileError>("cannot make a temporary file for the other joints' ripple: {}",
                         std::strerror(errno));
    try {
        require_joints(maps, log, options);
        LogStream stream(open_log(log.open(), reading_of(maps, options)));
        std::vector<std::unique_ptr<CausalFilter>> filters;
        std::vector<JointRun> runs;
        for (const JointColumns& joint : stream.reader().layout().all_chosen()) {
            const auto map = std::find_if(maps.begin(), maps.end(),
                                          [&](const RippleMap& one) { return one.joint == joint.joint; });
            filters.push_back(map_prediction(*map, stream.design_rate()));
            runs.push_back({filters.back().get()});
        }
        if (runs.size() != maps.size())
            raise<DataError>(
                "{}: the map also holds ripple of the motors of {}, and not all of them have a motion",
                stream.reader().layout().source, names_of(maps));
        SumOfJoints sum(file_);
        static_cast<void>(stream.run(runs, &sum));
    } catch (...) {
        std::fclose(file_);
        throw;
    }
    std::rewind(file_);
}

OtherRipple::~OtherRipple() { std::fclose(file_); }

std::span<const double> OtherRipple::next(std::size_t count) {
    values_.resize(count);
    if (std::fread(values_.data(), sizeof(double), count, file_) != count)
        raise<DataError>(
            "the log has grown since its other joints were read; read a copy that nobody writes to");
    return values_;
}

}  // namespace ripplenotch
