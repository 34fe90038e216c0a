// Opens the module and shows the robot that the address names; a file dropped anywhere opens.
'use strict';
(async () => {
  let evo;
  try {
    evo = Evo.evo = await Evo.load(await Evo.moduleBytes(), Evo.files);
  } catch (failure) {
    Evo.id('main').prepend(Evo.element('p', { class: 'notice', role: 'alert' },
      `The simulator does not start in this browser (${failure.message}); a newer one can.`));
    return;
  }
  const page = Evo.playPage(evo);
  const show = () => page.show(location.hash.slice(1));
  addEventListener('hashchange', show);
  await show();
  document.documentElement.dataset.ready = 'play';

  let over = 0;
  addEventListener('dragenter', (event) => { event.preventDefault(); ++over; document.body.classList.add('dropping'); });
  addEventListener('dragleave', () => { if (--over <= 0) document.body.classList.remove('dropping'); });
  addEventListener('dragover', (event) => event.preventDefault());
  addEventListener('drop', (event) => {
    event.preventDefault();
    over = 0;
    document.body.classList.remove('dropping');
    if (event.dataTransfer.files[0]) page.open(event.dataTransfer.files[0]);
  });
})();
