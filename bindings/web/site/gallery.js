// The wall of records: which are shown, and in which order.
'use strict';
(() => {
  const form = document.getElementById('choose'), wall = document.getElementById('wall'), cards = [...wall.children];
  const before = {
    order: (a, b) => a.order - b.order,
    name: (a, b) => a.name.localeCompare(b.name),
    lead: (a, b) => b.lead - a.lead,
  };
  const show = () => {
    const { find, difficulty, sort } = form.elements;
    for (const card of cards)
      card.hidden = !card.dataset.name.includes(find.value.trim().toLowerCase()) || (difficulty.value !== '' && card.dataset.difficulty !== difficulty.value);
    wall.append(...cards.sort((a, b) => before[sort.value](a.dataset, b.dataset)));
    document.getElementById('count').textContent = `${cards.filter((card) => !card.hidden).length} of ${cards.length}`;
  };
  form.addEventListener('input', show);
  form.addEventListener('submit', (event) => event.preventDefault());
  const still = document.getElementById('still');
  still.addEventListener('click', () => {
    const rest = still.getAttribute('aria-pressed') !== 'true';
    still.setAttribute('aria-pressed', String(rest));
    for (const { lastChild: image } of wall.querySelectorAll('picture')) image.src = image.src.replace(/...$/, rest ? 'png' : 'svg');
  });
  show();
})();
