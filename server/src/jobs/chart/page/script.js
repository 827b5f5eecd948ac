const points = JSON.parse(document.getElementById("points").textContent);
const box = document.getElementById("seen");
function show(number) {
  const point = points[number];
  for (const other of document.querySelectorAll(".seen")) other.classList.remove("seen");
  for (const same of document.querySelectorAll(`[data-point="${number}"]`)) same.classList.add("seen");
  box.querySelector("h3").textContent = point.label;
  for (const [id, file] of [["image", `${point.name}.png`], ["difference", `${point.name}-difference.png`]]) {
    const image = document.getElementById(id);
    image.src = file;
    image.alt = `${point.label}: ${id}`;
  }
  box.querySelector("dl").replaceChildren(...point.facts.flatMap(([name, value]) => {
    const [term, told] = [document.createElement("dt"), document.createElement("dd")];
    [term.textContent, told.textContent] = [name, value];
    return [term, told];
  }));
}
for (const element of document.querySelectorAll("[data-point]")) {
  const told = () => show(Number(element.dataset.point));
  element.addEventListener("mouseenter", told);
  element.addEventListener("focusin", told);
  // A click or a tap shows, Enter opens.
  if (element.closest(".chart")) element.addEventListener("click", (event) => {
    if (!element.classList.contains("seen") || event.detail) event.preventDefault();
    told();
  });
}
