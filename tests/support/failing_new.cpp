#include "tests/support/failing_new.h"

#include <cstdlib>
#include <new>

#include "tests/support/stack_hash.h"

namespace scenegen::test {

FailingNew& failing_new() {
  thread_local FailingNew one;
  return one;
}

}  // namespace scenegen::test

namespace {

bool fails() {
  auto& state = scenegen::test::failing_new();
  if (!state.armed || (state.exempt != nullptr && state.exempt())) return false;
  ++state.count;
  if (state.record) {
    state.armed = false;  // what follows allocates too
    state.stacks.push_back(scenegen::test::stack_hash());
    state.armed = true;
  }
  if (state.count != state.fail_at) return false;
  state.failed = true;
  return true;
}

}  // namespace

void* operator new(std::size_t size) {
  if (fails()) throw std::bad_alloc();
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  if (fails()) throw std::bad_alloc();
  const auto a = static_cast<std::size_t>(alignment);
  if (void* p = std::aligned_alloc(a, (size + a - 1) / a * a)) return p;
  throw std::bad_alloc();
}
// The nothrow form, too (std::stable_sort): the sanitizer's own would not match our delete.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return std::malloc(size == 0 ? 1 : size);
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}
