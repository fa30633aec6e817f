// Memory that a thread keeps from one sphere to the next.
#pragma once

#include <bit>
#include <cstddef>
#include <new>
#include <vector>

namespace miebrdf::mie {

/// Blocks that vectors of this thread have given back. Fresh memory of this size comes from the
/// system page by page, which takes longer than to fill it with partial waves.
class KeptMemory {
  public:
    static KeptMemory& of_thread() {
        thread_local KeptMemory kept;
        return kept;
    }

    KeptMemory() = default;
    KeptMemory(const KeptMemory&) = delete;
    KeptMemory& operator=(const KeptMemory&) = delete;
    ~KeptMemory() {
        for (const Block& block : blocks_) ::operator delete(block.memory);
    }

    void* take(std::size_t bytes) {
        for (std::size_t i = blocks_.size(); i-- > 0;) {
            if (blocks_[i].bytes != bytes) continue;
            void* memory = blocks_[i].memory;
            blocks_.erase(blocks_.begin() + static_cast<std::ptrdiff_t>(i));
            return memory;
        }
        return ::operator new(bytes);
    }

    void give_back(void* memory, std::size_t bytes) noexcept {
        if (bytes > kLargest) {
            ::operator delete(memory);
            return;
        }
        if (blocks_.capacity() == 0) blocks_.reserve(kMostBlocks);
        if (blocks_.size() == kMostBlocks) {
            ::operator delete(blocks_.front().memory);
            blocks_.erase(blocks_.begin());
        }
        blocks_.push_back({memory, bytes});
    }

  private:
    struct Block {
        void* memory;
        std::size_t bytes;
    };
    static constexpr std::size_t kMostBlocks = 16;
    static constexpr std::size_t kLargest = std::size_t(2) << 20;  // x = 2.5e5; 32 MB at most
    /// Given back longest ago first: those go when spheres of another size come.
    std::vector<Block> blocks_;
};

/// For vectors that live as long as one call. Blocks of a page or more are kept, in sizes of powers
/// of two, so that spheres of nearly the same x share them.
template <typename T>
struct KeptAllocator {
    using value_type = T;

    KeptAllocator() = default;
    template <typename U>
    KeptAllocator(const KeptAllocator<U>&) {}

    T* allocate(std::size_t count) {
        const std::size_t bytes = count * sizeof(T);
        if (bytes < kLeast) return static_cast<T*>(::operator new(bytes));
        return static_cast<T*>(KeptMemory::of_thread().take(std::bit_ceil(bytes)));
    }
    void deallocate(T* memory, std::size_t count) noexcept {
        const std::size_t bytes = count * sizeof(T);
        if (bytes < kLeast) {
            ::operator delete(memory);
        } else {
            KeptMemory::of_thread().give_back(memory, std::bit_ceil(bytes));
        }
    }
    template <typename U>
    bool operator==(const KeptAllocator<U>&) const {
        return true;
    }

  private:
    static constexpr std::size_t kLeast = 4096;
};

template <typename T>
using KeptVector = std::vector<T, KeptAllocator<T>>;

}  // namespace miebrdf::mie
