// SPDX-License-Identifier: MIT
#pragma once
// A filter method as the user wrote it, checked, with its table loaded and its gear chosen; and the methods
// of a log's joints.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

/// Maps by the names of their files.
using MapSource = std::function<RippleMap(const std::string& path)>;

/// `spec_text` as --method takes it; `table` is a table.json for methods that need one and name none. Keys of
/// the gear that the text leaves out are filled, and joint=FILE is replaced by the keys that it fills, so
/// that the contender's text says all. Throws UsageError on a bad specification, on a gear that is missing,
/// and what load_table, load_joint and refuse_other_gear throw. Maps are read from their files unless `maps`
/// has them.
[[nodiscard]] Contender choose_method(const std::string& spec_text,
                                      const std::optional<std::string>& table = std::nullopt,
                                      const GearChoice& gear = GearChoice({}), const MapSource& maps = {});

/// Throws UsageError, naming both, when the method's map is of a joint of another name than the log's.
void refuse_other_joint(const Contender& method, const std::string& joint);

/// Throws UsageError, naming both, when the method's filter is made for another gear ratio than that whose
/// ripple is measured: by more than 0.5 %, or than a table's own ratio error.
void refuse_other_gear(const Contender& method, const GearAccount& measured);

// The methods of a log's joints: one for all of them, or one each.

/// Stands for a joint's name in the names of files and in the keys of a method.
inline constexpr std::string_view joint_mark = "{joint}";
[[nodiscard]] bool names_joint(std::string_view text);
/// `text` with the joint's name in place of each mark; a name that is no file's, like arm/1, gets _ for /.
/// Throws UsageError when there is a mark and the joint has no name.
[[nodiscard]] std::string with_joint(std::string text, const std::string& joint);

/// As the command line has it; "{joint}" may stand in the names of methods and files.
struct MethodRequest {
    std::string method;
    std::optional<std::string> table;
    GearOptions gear;
    bool needs_gear = false;  ///< something was asked about the ripple's place
};

class JointMethods {
  public:
    /// Chooses at once where no text names the joint, so that what is wrong is said before a log is opened.
    /// Throws what choose_method throws, UsageError when a gear is needed and not known.
    explicit JointMethods(MethodRequest request);

    /// Throws the same, and what with_joint throws.
    [[nodiscard]] std::shared_ptr<const Contender> of(const std::string& joint) const;
    /// Of all joints; empty where each has its own, or nobody says it.
    [[nodiscard]] std::optional<GearAccount> common_gear() const;
    /// Whether the method looks at the whole log before it filters.
    [[nodiscard]] bool learns() const;
    /// Whether what the method does depends on how fast the joint turns.
    [[nodiscard]] bool follows_motion() const;

  private:
    [[nodiscard]] const Method& method() const;
    [[nodiscard]] std::shared_ptr<const Contender> choose(const std::string& joint) const;

    MethodRequest request_;
    std::shared_ptr<const Contender> common_;  ///< null when each joint has its own
};

}  // namespace ripplenotch
