// SPDX-License-Identifier: MIT
#pragma once
// --simulated: the torque of the user's own simulation, in a column of the log or in a log of its own.

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "ripplenotch/diagnose/setup.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// The same columns but for one role, which is this one. Throws UsageError of `option` where they are stated
/// by place.
[[nodiscard]] ReadOptions with_role(ReadOptions reading, const std::string& role, const std::string& column,
                                    std::string_view option);

class SimulationSource {
  public:
    /// "tau_model[,scale=1][,delay=2ms][,position=q_model][,velocity=dq_model]", the same as
    /// "column,name=tau_model...", or "log,file=sim.csv, column=torque[,validate=sim2.csv][,align=start]...".
    /// Beside a model that states a simulation it says only where its torque is: scale and delay are the
    /// model's. Throws UsageError.
    explicit SimulationSource(std::string_view text, const std::optional<SimulatedTerm>& stated = {});

    /// As a model.json states it: a column of the log.
    explicit SimulationSource(SimulatedTerm term) : term_(std::move(term)), states_delay_(true) {}

    /// The term for the rows of the log at `path`; its deviation is 0 where the scale is stated. Rows that a
    /// simulation in a file of its own does not span are taken out of the log. Throws UsageError, DataError,
    /// FileError.
    [[nodiscard]] GivenTerm read(const ReadOptions& reading, const std::string& path, Log& log) const;
    /// The same for the validation log, for which a simulation in a file of its own has another file.
    [[nodiscard]] GivenTerm read_validation(const ReadOptions& reading, const std::string& path,
                                            Log& log) const;
    /// The simulation itself, on its own clock (with align=start begun with the log): torque as it stands,
    /// and position and velocity where it has them. A simulation in columns of the log has those that
    /// position= and velocity= name; one in a file of its own has those that the file has. Throws as read().
    [[nodiscard]] SimulatedMotion read_motion(const ReadOptions& reading, const std::string& path,
                                              const Log& log) const;
    /// The same at the rows of the log, as its torque is.
    [[nodiscard]] SimulatedMotion read_motion_at(const ReadOptions& reading, const std::string& path,
                                                 const Log& log) const;
    [[nodiscard]] const SimulatedTerm& term() const { return term_; }
    /// Whether the user or the model says by how much the column is later than the log.
    [[nodiscard]] bool states_delay() const { return states_delay_; }
    /// Takes it from a comparison of the motions.
    void set_delay(double delay_s) { term_.delay_s = delay_s; }
    /// Names of the columns of its torque and motion, as the options have them.
    [[nodiscard]] SetupContext names() const;
    /// Of the simulation, where it has one of its own.
    [[nodiscard]] const std::optional<std::string>& file() const { return file_; }

  private:
    [[nodiscard]] GivenTerm from(ReadOptions reading, const std::string& path, Log& log) const;
    /// How the log that holds the simulation is read.
    [[nodiscard]] ReadOptions reading_of(ReadOptions reading) const;
    SimulatedTerm term_;
    std::optional<std::string> file_, validation_file_, position_, velocity_;
    bool align_start_ = false, states_delay_ = false;
};

}  // namespace ripplenotch
