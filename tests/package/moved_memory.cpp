// For LD_PRELOAD: all memory of a program begins as many bytes beyond a multiple of 64 as
// MIEBRDF_MEMORY_OFFSET says (0, 16, 32 or 48; what asks for an alignment itself gets that). Values
// must not depend on where in memory they are computed.
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>

// The allocator of glibc itself, by the names that it exports beside malloc and free.
extern "C" void* __libc_malloc(std::size_t);
extern "C" void __libc_free(void*);

namespace {

constexpr std::size_t kLine = 64;

// In front of what the program gets.
struct Header {
    void* block;
    std::size_t size;
};

Header& header_of(void* memory) { return static_cast<Header*>(memory)[-1]; }

std::size_t wanted_offset() {
    static const std::size_t offset = [] {
        const char* text = std::getenv("MIEBRDF_MEMORY_OFFSET");
        return text == nullptr ? 0 : static_cast<std::size_t>(std::atoi(text)) % kLine;
    }();
    return offset;
}

void* allocate(std::size_t size, std::size_t alignment, std::size_t offset) {
    const std::size_t more = sizeof(Header) + alignment + kLine;
    if (size > SIZE_MAX - more) return nullptr;
    void* block = __libc_malloc(size + more);
    if (block == nullptr) return nullptr;
    const auto least = reinterpret_cast<std::uintptr_t>(block) + sizeof(Header);
    const std::uintptr_t line = (least + alignment - 1) / alignment * alignment;
    void* memory = reinterpret_cast<void*>(line + offset);
    header_of(memory) = {block, size};
    return memory;
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) { return allocate(size, kLine, wanted_offset()); }

void free(void* memory) {
    if (memory != nullptr) __libc_free(header_of(memory).block);
}

void* calloc(std::size_t count, std::size_t size) {
    if (size != 0 && count > SIZE_MAX / size) return nullptr;
    void* memory = malloc(count * size);
    if (memory != nullptr) std::memset(memory, 0, count * size);
    return memory;
}

void* realloc(void* memory, std::size_t size) {
    void* larger = malloc(size);
    if (memory == nullptr || larger == nullptr) return larger;
    const std::size_t before = header_of(memory).size;
    std::memcpy(larger, memory, before < size ? before : size);
    free(memory);
    return larger;
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
    return allocate(size, alignment, 0);
}

void* memalign(std::size_t alignment, std::size_t size) { return allocate(size, alignment, 0); }

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
    *memory = allocate(size, alignment, 0);
    return *memory == nullptr ? ENOMEM : 0;
}

std::size_t malloc_usable_size(void* memory) {
    return memory == nullptr ? 0 : header_of(memory).size;
}
}
