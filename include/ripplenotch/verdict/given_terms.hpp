// SPDX-License-Identifier: MIT
#pragma once
// Where the terms that a model is given come together, for every command that knows them: those that options
// state, those that a model.json states, and the values that a diagnosis finds for them.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/arm_setup.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/diagnose/setup.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/verdict/arm_source.hpp"
#include "ripplenotch/verdict/simulation_source.hpp"

namespace ripplenotch {

/// Options that state a given term.
struct GivenOptions {
    std::optional<std::string> simulated;  ///< "tau_model,scale=1"
    std::optional<std::string> arm;        ///< "urdf,file=robot.urdf"

    [[nodiscard]] bool any() const { return simulated || arm; }
};

/// A log of one joint as a command reads it.
struct GivenLog {
    std::string path;
    Log& log;                          ///< rows that a given term does not span are taken out
    std::size_t most_rows = all_rows;  ///< of which it was held whole: as read_log_in_part
};

/// What is given of one joint. In the same order in both lists; `validation` is empty without a validation
/// log.
struct GivenTerms {
    std::vector<GivenTerm> log, validation;
    std::optional<SimulatedTerm> simulated;  ///< as stated
    std::optional<StatedArm> arm;            ///< as stated, or as --arm has it
    std::optional<ArmAccount> account;       ///< of the arm
    std::vector<std::string> files;          ///< that were read beside the logs
    std::optional<SetupAnswer> setup;        ///< of simulation and log, where it was asked for
    std::shared_ptr<GivenArm> fitted_arm;    ///< whose values are found with the rest; null: all are stated

    /// "simulated.scale", "arm.links": values that nobody states yet; empty: none.
    [[nodiscard]] std::vector<std::string> open() const;
};

/// One for a command; the arm of --arm is read and fitted once for all joints.
class GivenSource {
  public:
    /// `checks_setup`: whether a simulation is aligned with the log by their motions, and hypotheses on the
    /// set-up are tested.
    explicit GivenSource(GivenOptions options, bool checks_setup = false)
        : options_(std::move(options)), checks_setup_(checks_setup) {}

    /// `reading`: how the log is read, so that its further columns are read alike. Throws UsageError,
    /// DataError, FileError.
    [[nodiscard]] GivenTerms read(const ModelWithGiven& stated, const ReadOptions& reading,
                                  const GivenLog& log, const GivenLog* validation);
    [[nodiscard]] const GivenOptions& options() const { return options_; }
    /// The arm of --arm; read when it is first asked for.
    [[nodiscard]] std::shared_ptr<GivenArm> arm(const ReadOptions& reading, const std::string& path,
                                                std::size_t most_rows);

  private:
    void add_simulated(GivenTerms& terms, const ModelWithGiven& stated, const ReadOptions& reading,
                       const GivenLog& log, const GivenLog* validation);
    void check_setup(GivenTerms& terms, SimulationSource& simulated, const ModelWithGiven& stated,
                     const ReadOptions& reading, const GivenLog& log);
    void add_arm(GivenTerms& terms, const ModelWithGiven& stated, const ReadOptions& reading,
                 const GivenLog& log, const GivenLog* validation);

    GivenOptions options_;
    bool checks_setup_;
    std::map<std::size_t, std::shared_ptr<GivenArm>> arms_;  ///< by the most rows held
};

/// The improved model with the values of what is given.
[[nodiscard]] ModelWithGiven improved_model(const GivenTerms& given, const Diagnosis& diagnosis);

/// The joint whose log a model needs, where it says so and the user does not.
void take_joint_of(const ModelWithGiven& model, std::optional<std::string>& joint);

// What is given of a log's torque where nothing is left to be fitted: for commands that predict a torque.

/// The sum of what the model and the options state; rows of the log that it does not span are taken out.
/// Nothing given: empty. Throws UsageError for a value that is still to be fitted, and what GivenSource
/// throws.
[[nodiscard]] std::vector<double> stated_torque_along(const GivenOptions& options,
                                                      const ModelWithGiven& model, const ReadOptions& reading,
                                                      const GivenLog& log);

// --residual and --simulated of commands that look for ripple: in measured less predicted torque, where what
// the model knows is gone.

struct ResidualOptions {
    std::optional<std::string> model;  ///< --residual: a model.json; {joint} stands for a joint's name
    std::optional<std::string> simulated;

    [[nodiscard]] bool any() const { return model || simulated; }
};

/// What a prediction left of the torque of a log; both in Nm rms.
struct Residual {
    double before_nm = 0.0, after_nm = 0.0;
    std::optional<std::string> model;  ///< the file of the model; empty without one, and for standard input
};

/// Takes what model and simulation predict out of the torque of `log`, which was read by `reading` for one
/// joint. `logs`: how many logs there are, of which a simulation in a file of its own fits one only. Throws
/// UsageError, DataError, FileError.
Residual subtract_predicted(const ResidualOptions& residual, ReadOptions reading, std::size_t logs,
                            const GivenLog& log);

/// The joint that the model of --residual is for, where the user names none.
void take_joint_of(const ResidualOptions& residual, std::optional<std::string>& joint);

}  // namespace ripplenotch
