// Opens the module and shows the page that the address names: #play, #records, #tasks.
'use strict';
(async () => {
  const names = ['play', 'records', 'tasks'];
  let evo;
  try {
    evo = await Evo.load(await Evo.moduleBytes(), Evo.files);
  } catch (failure) {
    document.getElementById('main').prepend(Evo.element('p', { class: 'notice', role: 'alert' },
      `The simulator does not start in this browser (${failure.message}); a newer one can.`));
    return;
  }
  Evo.tasks = Evo.taskNames.map((name) => ({ name, difficulty: evo.task(name).difficulty }));
  Evo.evo = evo;
  const pages = {};
  const make = { play: Evo.playPage, records: Evo.recordsPage, tasks: Evo.tasksPage };
  const show = () => {
    const [name, query = ''] = location.hash.slice(1).split(/\?(.*)/s);
    const page = names.includes(name) ? name : 'play';
    if (Evo.page && Evo.page !== page) pages[Evo.page].hide();
    Evo.page = page;
    for (const each of names) {
      document.getElementById(`page-${each}`).hidden = each !== page;
      const link = document.querySelector(`[data-page=${each}]`);
      if (each === page) link.setAttribute('aria-current', 'page'); else link.removeAttribute('aria-current');
    }
    (pages[page] ??= make[page](evo)).show(query);
    document.documentElement.dataset.ready = page;
  };
  addEventListener('hashchange', () => { show(); scrollTo(0, 0); });
  show();

  // A file dropped anywhere opens in Play.
  let over = 0;
  addEventListener('dragenter', (event) => { event.preventDefault(); ++over; document.body.classList.add('dropping'); });
  addEventListener('dragleave', () => { if (--over <= 0) document.body.classList.remove('dropping'); });
  addEventListener('dragover', (event) => event.preventDefault());
  addEventListener('drop', (event) => {
    event.preventDefault();
    over = 0;
    document.body.classList.remove('dropping');
    const file = event.dataTransfer.files[0];
    if (!file) return;
    if (Evo.page !== 'play') { history.pushState(null, '', '#play'); show(); }
    pages.play.open(file);
  });
})();
