#include "allocations.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
#include <malloc.h>
#define BRINK_COUNTS_ALLOCATIONS 1
#else
#define BRINK_COUNTS_ALLOCATIONS 0
#endif

namespace {

std::atomic<bool> is_counting{false};
std::atomic<std::int64_t> calls{0};
std::atomic<std::int64_t> bytes{0};

#if BRINK_COUNTS_ALLOCATIONS
void count(std::size_t size) {
  if (!is_counting.load(std::memory_order_relaxed)) return;
  calls.fetch_add(1, std::memory_order_relaxed);
  bytes.fetch_add(static_cast<std::int64_t>(size), std::memory_order_relaxed);
}
#endif

}  // namespace

#if BRINK_COUNTS_ALLOCATIONS
// glibc lets a program replace its allocator ("Replacing malloc" in its manual); these count and hand on to it.
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming): glibc's own names
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)

void* malloc(std::size_t size) noexcept {
  count(size);
  return __libc_malloc(size);
}

void* calloc(std::size_t number, std::size_t size) noexcept {
  count(number * size);
  return __libc_calloc(number, size);
}

void* realloc(void* memory, std::size_t size) noexcept {
  count(size);
  return __libc_realloc(memory, size);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  count(size);
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept { return memalign(alignment, size); }

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  *memory = memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}
#endif

namespace brink::app {

void start_counting_allocations() {
  calls = 0;
  bytes = 0;
  is_counting = true;
}

std::optional<Allocations> stop_counting_allocations() {
  is_counting = false;
  if (BRINK_COUNTS_ALLOCATIONS == 0) return std::nullopt;
  return Allocations{calls, bytes};
}

std::optional<double> allocated_mb() {
#if BRINK_COUNTS_ALLOCATIONS
  const struct mallinfo2 info = ::mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd) / (1024.0 * 1024.0);
#else
  return std::nullopt;
#endif
}

}  // namespace brink::app
