// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <rths/broker/detail/layout.hpp>
#include <rths/broker/detail/shared_object.hpp>
#include <rths/replicated/scenario.hpp>

namespace rths::replicated {

/// One word in the object of a ring, by which a process asks the cards of the ring for a fault.
class FaultBox {
 public:
  /// @throws Error if there is no such ring   @setup
  explicit FaultBox(const std::string& ring);
  /// Marks the ring as one of images. From now on processes may ask.
  void open();
  [[nodiscard]] bool is_open() const;
  /// The fault that a process asks for.
  [[nodiscard]] std::optional<Action> asked() const;
  /// Tells that process that the fault has happened.
  void confirm();
  /// Asks for a fault. @returns false if it has not happened after a second
  [[nodiscard]] bool ask(const Action& action);

 private:
  [[nodiscard]] broker::Header& header() const {
    return *reinterpret_cast<broker::Header*>(page_.address());
  }
  broker::SharedObject object_;
  broker::Mapping page_;
};

}  // namespace rths::replicated
