"""check_manifests.py ROOT: deploy/images/kubernetes.yaml holds only fields that Kubernetes' own client knows, of the right types, and
its pods are probed where conav answers, bounded and without privileges; compose.yaml starts services that exist. Then it breaks the
manifest in ways that must be refused."""
import copy
import re
import sys
from pathlib import Path

import yaml
from kubernetes import client

KINDS = {"Namespace": "V1Namespace", "PersistentVolumeClaim": "V1PersistentVolumeClaim", "Deployment": "V1Deployment", "StatefulSet": "V1StatefulSet",
         "DaemonSet": "V1DaemonSet", "PodDisruptionBudget": "V1PodDisruptionBudget"}
VERSIONS = {"Namespace": "v1", "PersistentVolumeClaim": "v1", "PodDisruptionBudget": "policy/v1"}  # others: apps/v1
PLAIN = {"str": str, "int": int, "bool": bool}


def schema_faults(value: object, kind: str, where: str) -> list[str]:
    """What the model `kind` of the client does not know, misses or has in another type."""
    if kind.startswith(("list[", "dict(")):
        is_list, inner = kind.startswith("list["), kind[5:-1].split(", ")[-1]
        if not isinstance(value, list if is_list else dict):
            return [f"{where}: is no {kind}"]
        return [fault for key, item in (enumerate(value) if is_list else value.items()) for fault in schema_faults(item, inner, f"{where}.{key}")]
    if kind in PLAIN:
        return [] if type(value) is PLAIN[kind] else [f"{where}: {value!r} is no {kind}"]
    if kind in ("object", "datetime"):  # IntOrString, Quantity
        return [] if isinstance(value, (str, int)) else [f"{where}: {value!r} is no string or number"]
    model = getattr(client, kind)
    if not isinstance(value, dict):
        return [f"{where}: is no {kind}"]
    names = {key: attribute for attribute, key in model.attribute_map.items()}
    faults = [f"{where}.{key}: unknown" for key in value if key not in names]
    try:
        model(**{names[key]: item for key, item in value.items() if key in names})
    except ValueError as error:
        faults.append(f"{where}: {error}")
    return faults + [fault for key, item in value.items() if key in names
                     for fault in schema_faults(item, model.openapi_types[names[key]], f"{where}.{key}")]


def pod_faults(name: str, spec: dict, services: set[str], ports: dict[object, str]) -> list[str]:
    """A workload whose fields are known: what we ask of each."""
    template = spec["template"]
    pod = template["spec"]
    container = pod["containers"][0]
    words = " ".join(container["args"]).split()
    port = container.get("ports", [{}])[0]
    volumes = {volume["name"] for volume in pod.get("volumes", [])}
    probes = [container.get(probe, {}).get("httpGet", {}) for probe in ("startupProbe", "livenessProbe", "readinessProbe")]
    security, pod_security = container.get("securityContext", {}), pod.get("securityContext", {})
    rules = {
        "selects its pods": spec["selector"].get("matchLabels") == template["metadata"].get("labels"),
        "has a service of conav": words[words.index("up") + 1] in services,
        "is on the host's network": pod.get("hostNetwork") is True,
        "has --health on its own port": words[-2] == "--health" and words[-1] == str(port.get("containerPort")) and ports.setdefault(words[-1], name) == name,
        "is probed there": all(probe.get("port") == port.get("name") and probe.get("host") == "127.0.0.1" for probe in probes),
        "asks the right paths": [probe.get("path") for probe in probes] == ["/livez", "/livez", "/readyz"],
        "ends in time": pod.get("terminationGracePeriodSeconds", 30) >= 3,
        "has limits": {"cpu", "memory"} <= container.get("resources", {}).get("limits", {}).keys() & container["resources"].get("requests", {}).keys(),
        "is not root": pod_security.get("runAsNonRoot") is True and pod_security.get("runAsUser", 0) > 0,
        "has seccomp": pod_security.get("seccompProfile", {}).get("type") == "RuntimeDefault",
        "has no privilege": security.get("allowPrivilegeEscalation") is False and security.get("capabilities", {}).get("drop") == ["ALL"] and not security.get("privileged"),
        "has a read-only root": security.get("readOnlyRootFilesystem") is True,
        "has no token of the cluster": pod.get("automountServiceAccountToken") is False,
        "has the image's version": ":" in container["image"] and not container["image"].endswith(":latest"),
        "mounts its volumes": all(mount["name"] in volumes for mount in container.get("volumeMounts", [])),
        "is secured": {"name": "ROS_SECURITY_ENABLE", "value": "true"} in container.get("env", []),
    }
    return [f"{name}: not true: {rule}" for rule, holds in rules.items() if not holds]


def faults_of(items: list, services: set[str]) -> list[str]:
    faults, ports = [], {}
    for item in items:
        kind, where = item.get("kind"), f"{item.get('kind')} {item.get('metadata', {}).get('name')}"
        if kind not in KINDS or item.get("apiVersion") != VERSIONS.get(kind, "apps/v1"):
            faults.append(f"{where}: unknown kind or apiVersion")
            continue
        found = schema_faults(item, KINDS[kind], where)
        if not found and "template" in item.get("spec", {}):
            found = pod_faults(where, item["spec"], services, ports)
        faults += found
    return faults


def main() -> int:
    images = Path(sys.argv[1]) / "deploy/images"
    services = {path.stem.replace("_", "-") for path in (images / "../config").glob("*.yaml")} - {"robot"} | {"driver"}
    items = yaml.safe_load((images / "kubernetes.yaml").read_text())["items"]
    faults = faults_of(items, services)
    version = re.search(r"^project\(conav VERSION ([0-9.]+)", (images / "../../CMakeLists.txt").read_text(), re.MULTILINE)[1]
    for name in ("kubernetes.yaml", "compose.yaml"):
        if set(re.findall(r"/conav:([0-9.]+)", (images / name).read_text())) != {version}:
            faults.append(f"{name}: its image is not of version {version}")
    for name, service in yaml.safe_load((images / "compose.yaml").read_text())["services"].items():
        if service["command"][:4] != ["up", name, "--config", f"/etc/conav/{name}.yaml"] or name not in services:
            faults.append(f"compose.yaml: {name}: its command does not start it")
    for line in faults:
        print(line)

    pod, container = "spec.template.spec", "spec.template.spec.containers.0"
    breaks = [("spec.replica", 1), ("spec.replicas", "1"), (f"{pod}.hostNetwork", False), (f"{pod}.securityContext.runAsNonRoot", False),
              (f"{container}.livenessProbe.httpGet.port", 9), (f"{container}.livenessProbe.httpget", {}), (f"{container}.readinessProbe", {}),
              (f"{container}.resources.limits", {}), (f"{container}.args.1", "operators"), (f"{container}.name", None), (f"{container}.image", "conav:latest"),
              (f"{container}.securityContext.readOnlyRootFilesystem", False), (f"{container}.volumeMounts.0.name", "none"), ("apiVersion", "apps/v2")]
    for path, value in breaks:
        broken = copy.deepcopy(next(item for item in items if item["kind"] == "Deployment"))
        *parents, last = (int(word) if word.isdigit() else word for word in path.split("."))
        place = broken
        for word in parents:
            place = place[word]
        place[last] = value
        if not faults_of([broken], services):
            faults.append(path)
            print(f"{path} = {value!r} is not refused")
    print(f"{len(items)} objects, {len(breaks)} broken ones, {len(faults)} faults")
    return 1 if faults else 0


sys.exit(main())
