// A Vulkan layer that tells of no more than 4096 texels along an image, half of what WebGPU asks. The
// structures are those of the Vulkan 1.0 specification and of the loader's interface for layers, version 2,
// so far as they are used here.

#include <stdint.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))

typedef void (*Function)(void);
typedef Function (*GetProc)(void *instance, const char *name);

typedef struct {
    uint32_t versions_and_kind[5];
    char name[256];
    uint8_t cache_id[16];
    // VkPhysicalDeviceLimits, which begins with these.
    _Alignas(8) uint32_t most_texels_1d;
    uint32_t most_texels_2d;
} Properties;

typedef struct {
    uint32_t type;
    void *next;
    Properties properties;
} Properties2;

typedef struct Link {
    struct Link *next;
    GetProc get_proc;
} Link;

// What the loader puts into the chain of vkCreateInstance.
typedef struct Chained {
    uint32_t type;
    struct Chained *next;
    uint32_t function;
    Link *link;
} Chained;

typedef struct {
    uint32_t type;
    void *next;
    uint32_t version;
    GetProc get_instance_proc, get_device_proc, get_physical_device_proc;
} Negotiation;

enum { LOADER_INSTANCE_CREATE_INFO = 47, LAYER_LINK_INFO = 0, ERROR_INITIALIZATION_FAILED = -3 };

static GetProc next_get_proc;
// What the next layer or the driver has, asked for while the instance is made: later the loader gives ours.
static void (*next_properties)(void *, Properties *);
static void (*next_properties_2)(void *, Properties2 *);

static void get_properties(void *adapter, Properties *properties) {
    next_properties(adapter, properties);
    properties->most_texels_2d = 4096;
}

static void get_properties_2(void *adapter, Properties2 *properties) {
    next_properties_2(adapter, properties);
    properties->properties.most_texels_2d = 4096;
}

static int32_t create_instance(const Chained *wanted, const void *allocator, void **instance) {
    Chained *info = wanted->next;
    while (info && !(info->type == LOADER_INSTANCE_CREATE_INFO && info->function == LAYER_LINK_INFO)) {
        info = info->next;
    }
    if (!info) {
        return ERROR_INITIALIZATION_FAILED;
    }
    next_get_proc = info->link->get_proc;
    info->link = info->link->next;
    int32_t (*create)(const void *, const void *, void **) =
        (int32_t (*)(const void *, const void *, void **))next_get_proc(0, "vkCreateInstance");
    int32_t result = create(wanted, allocator, instance);
    if (result == 0) {
        next_properties = (void (*)(void *, Properties *))next_get_proc(*instance, "vkGetPhysicalDeviceProperties");
        next_properties_2 = (void (*)(void *, Properties2 *))next_get_proc(*instance, "vkGetPhysicalDeviceProperties2");
    }
    return result;
}

static Function get_instance_proc(void *instance, const char *name) {
    if (!strcmp(name, "vkCreateInstance")) {
        return (Function)create_instance;
    }
    if (!strcmp(name, "vkGetInstanceProcAddr")) {
        return (Function)get_instance_proc;
    }
    if (!strcmp(name, "vkGetPhysicalDeviceProperties")) {
        return (Function)get_properties;
    }
    if (!strcmp(name, "vkGetPhysicalDeviceProperties2") || !strcmp(name, "vkGetPhysicalDeviceProperties2KHR")) {
        return (Function)get_properties_2;
    }
    return next_get_proc ? next_get_proc(instance, name) : 0;
}

EXPORT int32_t vkNegotiateLoaderLayerInterfaceVersion(Negotiation *negotiation) {
    negotiation->version = 2;
    negotiation->get_instance_proc = get_instance_proc;
    negotiation->get_device_proc = 0;
    negotiation->get_physical_device_proc = 0;
    return 0;
}
