// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

namespace ydd {

/// What a user can mend: one line that names the file, key or frame and the way out.
struct Error {
  std::string message;  ///< without a line break, for people
};

/// A value, or the reason why input did not give one.
///
/// `Result` is for what input can cause. A broken invariant throws std::logic_error instead, and
/// expected outcomes ("lost", "no loop") are values of their own types.
template <class T>
class [[nodiscard]] Result {
 public:
  /// Success.
  Result(T value) : state_(std::move(value)) {}  // NOLINT(google-explicit-constructor)
  /// Failure.
  Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool ok() const { return std::holds_alternative<T>(state_); }  ///< Whether there is a value.
  explicit operator bool() const { return ok(); }                ///< The same.

  /// @throws std::logic_error if there is no value.
  T& value() & {
    require();
    return std::get<T>(state_);
  }
  /// Of what may not be changed. @throws std::logic_error when there is none.
  const T& value() const& {
    require();
    return std::get<T>(state_);
  }
  /// Moves the value out.
  T value() && {
    require();
    return std::get<T>(std::move(state_));
  }
  T& operator*() & { return value(); }                   ///< As value().
  const T& operator*() const& { return value(); }        ///< As value().
  T operator*() && { return std::move(*this).value(); }  ///< Moves the value out.
  T* operator->() { return &value(); }                   ///< As value().
  const T* operator->() const { return &value(); }       ///< As value().

  /// @throws std::bad_variant_access if there is a value.
  const Error& error() const { return std::get<Error>(state_); }

 private:
  void require() const {
    if (!ok()) throw std::logic_error("Result has no value: " + error().message);
  }
  std::variant<T, Error> state_;
};

/// Of what gives nothing: done, or the reason why not.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  /// Failure.
  Result(Error error) : error_(std::move(error)), ok_(false) {}  // NOLINT

  bool ok() const { return ok_; }                 ///< Whether it was done.
  explicit operator bool() const { return ok_; }  ///< The same.
  const Error& error() const { return error_; }   ///< Why not; only after a failure.

 private:
  Error error_;
  bool ok_ = true;
};

}  // namespace ydd
