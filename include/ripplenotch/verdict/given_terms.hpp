// SPDX-License-Identifier: MIT
#pragma once
// What is given of a joint's torque: the rigid bodies of its arm, and a simulation of the user's own. Terms
// come together here, those that are stated in words, those that a model.json states, and the values that a
// diagnosis finds for them.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/arm_setup.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/diagnose/setup.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/verdict/other_motors.hpp"

namespace ripplenotch {

class SimulationSource;  // a simulation as it is stated, and where its column is

struct ArmSource {
    Chain chain;          ///< without joints that are kept still
    StatedJoints stated;  ///< partners in the log
    std::string words;    ///< as it would be typed again
    std::optional<std::string> file = {};
};

/// Reads the file that the words name. Throws UsageError for the words, what the readers of chains throw for
/// the file.
[[nodiscard]] ArmSource read_arm_source(std::string_view words);

// All joints of an arm from one log, in the order of its chain.

struct ArmReading {
    std::vector<Log> logs;  ///< a joint of the chain each
    JointMatch match;
    std::vector<std::string> names;  ///< of the joints in the log, in the order of the chain

    [[nodiscard]] ArmLog view() const;
    /// The place in the chain of a joint by its name in the log or in the chain, whatever its case. Throws
    /// UsageError with the nearest name.
    [[nodiscard]] std::size_t find(const Chain& chain, const std::string& joint) const;
};

// An arm and a log of its joints: the term that a diagnosis of one of them is given, and what is told of it.

class GivenArm {
  public:
    /// Reads the log, as read_arm, and so any other one. `smoothing`: of the motion that the arm sees; left
    /// out: the fit chooses it. Throws what read_arm and arm_travel throw.
    GivenArm(ArmSource option, const std::string& path, const ReadOptions& options,
             std::optional<Seconds> smoothing = {}, std::size_t most_rows = all_rows);

    [[nodiscard]] const Chain& chain() const { return option_.chain; }
    /// That the chain was read from.
    [[nodiscard]] const std::optional<std::string>& file() const { return option_.file; }
    [[nodiscard]] const ArmReading& reading() const { return reading_; }
    /// Another log of the same arm, matched alike; read when it is first asked for.
    [[nodiscard]] const ArmReading& other(const std::string& path, const ReadOptions& options);
    /// The place in the chain of a joint of the log.
    [[nodiscard]] std::size_t find(const std::string& joint) const { return reading_.find(chain(), joint); }

    /// One fit for all joints; where lengths are guessed, rows of two joints do not agree, and each has a fit
    /// of its own. Made when it is first asked for.
    const ArmFit& fit(std::size_t joint);
    /// What a joint's torque holds of its own motor and of those of other joints, in what arm and friction
    /// leave of it.
    [[nodiscard]] MapFit ripple(std::size_t joint, GearRatio ratio);
    /// Faults of arm and log, of all joints at once where they have one fit. Found when first asked for.
    const std::vector<SetupFault>& setup_faults(std::size_t joint);
    /// Columns for the rows of the log that the arm was fitted to, or for those of another one; `log` is
    /// reading() or other().
    [[nodiscard]] GivenTerm term(std::size_t joint, const ArmReading& log);
    /// Velocities of the joints along reading() or other(), that of `joint` and of those that slide empty.
    [[nodiscard]] std::vector<std::vector<double>> others_deg_s(std::size_t joint, const ArmReading& log);
    [[nodiscard]] ArmAccount account(std::size_t joint);
    /// The same of an arm whose values are stated, which has no fit.
    [[nodiscard]] ArmAccount stated_account(std::size_t joint, Seconds smoothing) const;

  private:
    [[nodiscard]] const std::vector<Motion>& motions(const ArmReading& log, Seconds smoothing);
    ArmSource option_;
    std::optional<Seconds> smoothing_;
    std::size_t max_rows_;
    ArmReading reading_;
    std::map<std::string, ArmReading> others_;  ///< by path
    std::vector<JointTravel> travel_;
    /// Of a log, for all its joints; by smoothing.
    std::map<std::pair<const ArmReading*, double>, std::vector<Motion>> motions_;
    struct Fitted {
        ArmFit fit;  ///< of the torques moved ahead by the common lag, where it is applied
        std::vector<SetupFault> faults;
        std::optional<ArmLag> lag;
    };
    [[nodiscard]] const Fitted& fitted(std::size_t joint);
    [[nodiscard]] bool is_applied(const ArmLag& lag) const;
    struct Remaining {
        std::vector<Log> log;  ///< its torque less arm and friction, ahead by the common lag
        Identification found;
    };
    const Remaining& remaining(std::size_t joint);
    std::map<std::size_t, Remaining> remaining_;  ///< by joint
    [[nodiscard]] ArmFitOptions options_for(std::size_t joint) const;
    std::map<std::size_t, Fitted> fits_;  ///< by joint; all joints at once: under 0
};

// What is given of one joint.

/// Options that state a given term.
struct GivenOptions {
    std::optional<std::string> simulated;  ///< "tau_model,scale=1"
    std::optional<std::string> arm;        ///< "urdf,file=robot.urdf"
    bool finds_ripple = true;              ///< with an arm, where the model states none

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
    /// The simulation's own motion at the rows of the log; empty where it has none.
    std::vector<double> simulated_velocity_deg_s, simulated_position_deg;
    /// Velocities of the arm's joints at the rows of each log, as Motion has them.
    std::vector<std::vector<double>> others_deg_s, validation_others_deg_s;
    std::optional<StatedArm> arm;          ///< as stated, or as --arm has it
    std::optional<ArmAccount> account;     ///< of the arm
    std::optional<MapFit> ripple;          ///< as stated, or as it is found with the arm
    std::vector<std::string> files;        ///< that were read in addition to the logs
    std::optional<SetupAnswer> setup;      ///< of simulation and log, where it was asked for
    std::shared_ptr<GivenArm> fitted_arm;  ///< whose values are found with the rest; null: all are stated
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

/// What a Motion has of an arm and a simulation; empty where nothing is given.
struct KnownAlong {
    std::vector<double> known_nm;
    std::vector<std::vector<double>> others_deg_s;
};

/// The sum of what the model and the options state; rows of the log that it does not span are taken out.
/// Throws UsageError for a value that is still to be fitted, and what GivenSource throws.
[[nodiscard]] KnownAlong stated_along(const GivenOptions& options, const ModelWithGiven& model,
                                      const ReadOptions& reading, const GivenLog& log);

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
